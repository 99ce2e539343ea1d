#include "drivers/sensor/openni2/openni2_session.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "drivers/sensor/openni2/openni2_frame.h"
#include "drivers/sensor/openni2/openni2_runtime.h"

static const char owner[] = "sensor openni2";

enum {
    PLAYER_MS = 2000, /* a file that gives no frame for so long is stuck */
    PLAYER_NAP_MS = 3,
    RECORDER_LOOK_MS = 20,
    RECORDER_STILL = 3,  /* looks without a change that mean that it waits for frames */
    RECORDER_LOOKS = 50, /* at most */
};

/* ---- what happens to the device --------------------------------------------- */

static bool is_ours(const struct iso__openni2_session *session, const OniDeviceInfo *info)
{
    return strcmp(session->info.uri, info->uri) == 0;
}

static void on_disconnected(const OniDeviceInfo *info, void *cookie)
{
    struct iso__openni2_session *session = cookie;
    if (is_ours(session, info)) {
        atomic_store(&session->gone, true);
    }
}

static void on_state(const OniDeviceInfo *info, OniDeviceState state, void *cookie)
{
    struct iso__openni2_session *session = cookie;
    if (is_ours(session, info)) {
        atomic_store(&session->state, (int)state);
    }
}

static int watch(struct iso__openni2_session *session, struct iso_fault *fault)
{
    OniDeviceCallbacks callbacks = {
        .deviceDisconnected = on_disconnected,
        .deviceStateChanged = on_state,
    };
    const OniStatus status = oniRegisterDeviceCallbacks(&callbacks, session, &session->watch);
    return status == ONI_STATUS_OK ? 0 : iso__openni2_refuse(status, "cannot be watched", fault);
}

/* ---- streams ---------------------------------------------------------------- */

static int get(OniStreamHandle stream, int property, void *value, int size)
{
    return oniStreamGetProperty(stream, property, value, &size) == ONI_STATUS_OK ? 0 : -EIO;
}

/* Turns mirroring off; a file says what its frames are, and is believed rather than told. */
static void unmirror(const struct iso__openni2_session *session, struct iso__openni2_stream *stream)
{
    const OniBool off = FALSE;
    OniBool mirroring = FALSE;
    if (!session->file) {
        (void)oniStreamSetProperty(stream->handle, ONI_STREAM_PROPERTY_MIRRORING, &off, sizeof off);
    }
    stream->mirrored = get(stream->handle, ONI_STREAM_PROPERTY_MIRRORING, &mirroring,
                           sizeof mirroring) == 0 &&
                       mirroring;
}

/* How many frames a stream of a file has. Its end is known by that: the runtime tells of it too,
 * but from another thread and at its own time. */
static int count_frames(const struct iso__openni2_session *session,
                        struct iso__openni2_stream *stream, struct iso_fault *fault)
{
    if (get(stream->handle, ONI_STREAM_PROPERTY_NUMBER_OF_FRAMES, &stream->n_frames,
            sizeof stream->n_frames)) {
        return iso_fault_set(fault, -EIO, "%s: %s: does not tell how many frames it has", owner,
                             session->info.uri);
    }
    return 0;
}

static bool modes_equal(const OniVideoMode *a, const OniVideoMode *b)
{
    return a->pixelFormat == b->pixelFormat && a->resolutionX == b->resolutionX &&
           a->resolutionY == b->resolutionY && a->fps == b->fps;
}

/* Claims a stream of the device, whole image and unmirrored, in the best of its modes: the one for
 * which `rank` gives the most, 0 being unfit. */
static int claim_stream(struct iso__openni2_session *session, OniSensorType type,
                        int (*rank)(const OniVideoMode *mode, const OniVideoMode *now,
                                    const void *context),
                        const void *context, struct iso__openni2_stream *stream,
                        struct iso_fault *fault)
{
    const char *name = type == ONI_SENSOR_DEPTH ? "depth" : "intensity";
    const OniCropping whole = {.enabled = FALSE};
    OniVideoMode now = {0}, best = {0};
    int best_rank = 0;
    OniStatus status = oniDeviceCreateStream(session->device, type, &stream->handle);
    if (status != ONI_STATUS_OK) {
        stream->handle = NULL;
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EINVAL,
                                  "%s: %s: has no %s stream", owner, session->info.uri, name);
    }
    const OniSensorInfo *sensor = oniStreamGetSensorInfo(stream->handle);
    if (!sensor || get(stream->handle, ONI_STREAM_PROPERTY_VIDEO_MODE, &now, sizeof now)) {
        return iso__openni2_refuse(ONI_STATUS_ERROR, "video modes cannot be read", fault);
    }
    for (int i = 0; i < sensor->numSupportedVideoModes; i++) {
        const int value = rank(&sensor->pSupportedVideoModes[i], &now, context);
        if (value > best_rank) {
            best_rank = value;
            best = sensor->pSupportedVideoModes[i];
        }
    }
    if (best_rank == 0) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EINVAL,
                                  "%s: %s: no %s mode of %d fits; now it is %dx%d@%d, format %d",
                                  owner, session->info.uri, name, sensor->numSupportedVideoModes,
                                  now.resolutionX, now.resolutionY, now.fps, now.pixelFormat);
    }
    if (!modes_equal(&best, &now)) {
        status = oniStreamSetProperty(stream->handle, ONI_STREAM_PROPERTY_VIDEO_MODE, &best,
                                      sizeof best);
        if (status != ONI_STATUS_OK) {
            return iso__openni2_refuse(status, "video mode is refused", fault);
        }
    }
    stream->mode = best;
    if (!session->file) {
        (void)oniStreamSetProperty(stream->handle, ONI_STREAM_PROPERTY_CROPPING, &whole,
                                   sizeof whole);
    }
    unmirror(session, stream);
    return session->file ? count_frames(session, stream, fault) : 0;
}

/* A mode of the wanted size and rate, or of those that it has now; the finer unit first. */
static int rank_depth(const OniVideoMode *mode, const OniVideoMode *now, const void *context)
{
    const struct iso__openni2_wish *wish = context;
    const double unit_mm = iso__openni2_unit_mm(mode->pixelFormat);
    const bool fits = unit_mm > 0.0 &&
                      (wish->unit_um == 0 || wish->unit_um == (int)(unit_mm * 1000.0 + 0.5)) &&
                      mode->resolutionX == (wish->width_px ? wish->width_px : now->resolutionX) &&
                      mode->resolutionY == (wish->height_px ? wish->height_px : now->resolutionY) &&
                      mode->fps == (wish->fps ? wish->fps : now->fps);
    return fits ? (unit_mm < 1.0 ? 2 : 1) : 0;
}

/* A mode of the size of the depths; as many bits and frames as there are. */
static int rank_grey(const OniVideoMode *mode, const OniVideoMode *now, const void *context)
{
    const OniVideoMode *depth = context;
    (void)now;
    if (mode->resolutionX != depth->resolutionX || mode->resolutionY != depth->resolutionY) {
        return 0;
    }
    const int same_rate = mode->fps == depth->fps ? 4 : 0;
    switch (mode->pixelFormat) {
    case ONI_PIXEL_FORMAT_GRAY16:
        return same_rate + 3;
    case ONI_PIXEL_FORMAT_GRAY8:
        return same_rate + 2;
    case ONI_PIXEL_FORMAT_RGB888:
        return same_rate + 1;
    default:
        return 0;
    }
}

/* Has the device move the depths to where the colour camera sees them. */
static int register_to_color(const struct iso__openni2_session *session, struct iso_fault *fault)
{
    const OniImageRegistrationMode mode = ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    if (session->file) {
        return iso_fault_set(fault, -EINVAL,
                             "%s: %s: a file does not say whether its colours are registered",
                             owner, session->info.uri);
    }
    if (!oniDeviceIsImageRegistrationModeSupported(session->device, mode) ||
        oniDeviceSetProperty(session->device, ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION, &mode,
                             sizeof mode) != ONI_STATUS_OK) {
        return iso_fault_set(fault, -EINVAL, "%s: %s: cannot register depths to colours", owner,
                             session->info.uri);
    }
    (void)oniDeviceEnableDepthColorSync(session->device); /* without it they are paired by time */
    return 0;
}

static int open_grey(struct iso__openni2_session *session, enum iso__openni2_grey grey,
                     struct iso_fault *fault)
{
    int error = grey == ISO__OPENNI2_COLOR ? register_to_color(session, fault) : 0;
    if (!error) {
        error = claim_stream(session, grey == ISO__OPENNI2_IR ? ONI_SENSOR_IR : ONI_SENSOR_COLOR,
                             rank_grey, &session->depth.mode, &session->grey, fault);
    }
    if (!error) {
        int top = 0;
        const bool wide = session->grey.mode.pixelFormat == ONI_PIXEL_FORMAT_GRAY16;
        const bool told = wide &&
                          get(session->grey.handle, ONI_STREAM_PROPERTY_MAX_VALUE, &top,
                              sizeof top) == 0 &&
                          top > 0 && top <= UINT16_MAX;
        session->grey.full_scale = told ? top : wide ? UINT16_MAX : UINT8_MAX;
    }
    return error;
}

/* The camera of the depths; registered ones are seen by the colour camera. */
static int find_camera(struct iso__openni2_session *session, enum iso__openni2_grey grey,
                       struct iso_fault *fault)
{
    const OniStreamHandle eye = grey == ISO__OPENNI2_COLOR ? session->grey.handle
                                                           : session->depth.handle;
    const OniVideoMode *mode = &session->depth.mode;
    const char *what = NULL;
    float x_rad = 0, y_rad = 0;
    if (get(eye, ONI_STREAM_PROPERTY_HORIZONTAL_FOV, &x_rad, sizeof x_rad) ||
        get(eye, ONI_STREAM_PROPERTY_VERTICAL_FOV, &y_rad, sizeof y_rad)) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EIO,
                                  "%s: %s: does not tell its field of view", owner,
                                  session->info.uri);
    }
    session->camera = iso__openni2_camera(mode->resolutionX, mode->resolutionY, (double)x_rad,
                                          (double)y_rad);
    if (iso_camera_check(&session->camera, &what)) {
        return iso_fault_set(fault, -EIO, "%s: %s: view of %g x %g rad: %s", owner,
                             session->info.uri, (double)x_rad, (double)y_rad, what);
    }
    return 0;
}

/* ---- opening and closing ---------------------------------------------------- */

/* Of a file: frames one by one as they are asked for. */
static int set_playback(const struct iso__openni2_session *session, struct iso_fault *fault)
{
    const float on_demand = -1.0F;
    const OniBool repeat = session->loop;
    OniStatus status = oniDeviceSetProperty(session->device, ONI_DEVICE_PROPERTY_PLAYBACK_SPEED,
                                            &on_demand, sizeof on_demand);
    if (status == ONI_STATUS_OK) {
        status = oniDeviceSetProperty(session->device, ONI_DEVICE_PROPERTY_PLAYBACK_REPEAT_ENABLED,
                                      &repeat, sizeof repeat);
    }
    return status == ONI_STATUS_OK ? 0 : iso__openni2_refuse(status, "cannot be played", fault);
}

static int open_device(struct iso__openni2_session *session, const struct iso__openni2_wish *wish,
                       struct iso_fault *fault)
{
    const OniStatus status = oniDeviceOpen(session->info.uri, &session->device);
    if (status != ONI_STATUS_OK) {
        session->device = NULL;
        return iso__openni2_refuse(status, session->info.uri, fault);
    }
    (void)oniDeviceGetInfo(session->device, &session->info);
    iso__openni2_read_serial(session->device, session->serial);
    int error = session->file ? set_playback(session, fault) : 0;
    if (!error) {
        error = claim_stream(session, ONI_SENSOR_DEPTH, rank_depth, wish, &session->depth, fault);
    }
    if (!error && wish->grey != ISO__OPENNI2_NO_GREY) {
        error = open_grey(session, wish->grey, fault);
    }
    return error ? error : find_camera(session, wish->grey, fault);
}

int iso__openni2_session_open(struct iso__openni2_session *session,
                              const struct iso__openni2_wish *wish, struct iso_fault *fault)
{
    memset(session, 0, sizeof *session);
    int error = iso__openni2_start_runtime(fault);
    if (error) {
        return error;
    }
    session->running = true;
    session->loop = wish->loop;
    session->file = wish->path != NULL;
    error = session->file ? iso__openni2_find_file(wish->path, &session->info, fault)
                          : iso__openni2_find_device(wish->device, &session->info, fault);
    error = error ? error : watch(session, fault);
    error = error ? error : open_device(session, wish, fault);
    session->opened = !error;
    if (error == -ENODEV) {
        iso__openni2_stay();
    }
    if (error) {
        iso__openni2_session_close(session);
    }
    return error;
}

/* The player's thread goes through the list of its streams without a lock: over and over at the end
 * of a file, and once in 10 ms while they are stopped. Destroying them then is seen to crash. A
 * short while after the stop, it sleeps. */
static void let_player_sleep(void)
{
    const struct timespec while_ns = {0, PLAYER_NAP_MS * 1000000};
    (void)nanosleep(&while_ns, NULL);
}

void iso__openni2_session_close(struct iso__openni2_session *session)
{
    iso__openni2_session_stop(session);
    if (session->file && session->depth.handle) {
        let_player_sleep();
    }
    if (session->grey.handle) {
        oniStreamDestroy(session->grey.handle);
    }
    if (session->depth.handle) {
        oniStreamDestroy(session->depth.handle);
    }
    if (session->device) {
        (void)oniDeviceClose(session->device);
    }
    if (session->watch) {
        oniUnregisterDeviceCallbacks(session->watch);
    }
    if (session->opened) {
        iso__openni2_leave();
    }
    if (session->running) {
        oniShutdown();
    }
    memset(session, 0, sizeof *session);
}

/* ---- streaming -------------------------------------------------------------- */

/* The recorder starts in a thread of its own and throws away what comes before, without a word. It
 * writes the streams' properties first: when its file has stopped growing, it has started. */
static void wait_for_recorder(const char *record)
{
    const struct timespec look = {0, RECORDER_LOOK_MS * 1000000};
    off_t size = 0;
    for (int looks = 0, still = 0; looks < RECORDER_LOOKS && still < RECORDER_STILL; looks++) {
        struct stat status = {.st_size = 0};
        (void)nanosleep(&look, NULL);
        (void)stat(record, &status);
        still = status.st_size > 0 && status.st_size == size ? still + 1 : 0;
        size = status.st_size;
    }
}

/* Begins when the streams run: a recorder counts the time of each from its own first frame, so that
 * those of depth and intensity have to be of one exposure. */
static int start_recorder(struct iso__openni2_session *session, const char *record,
                          struct iso_fault *fault)
{
    OniStatus status = oniCreateRecorder(record, &session->recorder);
    if (status != ONI_STATUS_OK) {
        session->recorder = NULL;
        return iso__openni2_refuse(status, record, fault);
    }
    status = oniRecorderAttachStream(session->recorder, session->depth.handle, FALSE);
    if (status == ONI_STATUS_OK && session->grey.handle) {
        status = oniRecorderAttachStream(session->recorder, session->grey.handle, FALSE);
    }
    if (status == ONI_STATUS_OK) {
        status = oniRecorderStart(session->recorder);
    }
    if (status != ONI_STATUS_OK) {
        return iso__openni2_refuse(status, record, fault);
    }
    wait_for_recorder(record);
    return 0;
}

int iso__openni2_session_start(struct iso__openni2_session *session, const char *record,
                               struct iso_fault *fault)
{
    atomic_store(&session->state, ONI_DEVICE_STATE_OK);
    OniStatus status = oniStreamStart(session->depth.handle);
    if (status == ONI_STATUS_OK && session->grey.handle) {
        status = oniStreamStart(session->grey.handle);
    }
    int error = status == ONI_STATUS_OK ? 0 : iso__openni2_refuse(status, "does not start", fault);
    if (!error && record) {
        error = start_recorder(session, record, fault);
    }
    if (atomic_load(&session->gone)) { /* the runtime starts what is not there without a word */
        error = iso_fault_set_code(fault, ISO_FAULT_SENSOR_GONE, -ENODEV,
                                   "%s: %s: the device is gone", owner, session->info.uri);
    }
    if (error) {
        iso__openni2_session_stop(session);
    }
    return error;
}

static void stop_streams(struct iso__openni2_session *session)
{
    if (session->grey.handle) {
        oniStreamStop(session->grey.handle);
    }
    if (session->depth.handle) {
        oniStreamStop(session->depth.handle);
    }
}

void iso__openni2_session_stop(struct iso__openni2_session *session)
{
    if (session->recorder) {
        oniRecorderStop(session->recorder);
        (void)oniRecorderDestroy(&session->recorder);
        session->recorder = NULL;
    }
    stop_streams(session);
}

bool iso__openni2_session_ended(const struct iso__openni2_session *session)
{
    return session->file && !session->loop && session->depth.taken >= session->depth.n_frames &&
           (!session->grey.handle || session->grey.taken >= session->grey.n_frames);
}

/* Each look of the runtime's for a frame has the player read one, and one that is not fetched is
 * overwritten by the next: it must look once. A frame that came while nobody waited has left the
 * thread's event set, which would let it look twice. Waiting for no stream clears that. */
static void forget_old_news(void)
{
    OniStreamHandle none[] = {NULL};
    int which = 0;
    (void)oniWaitForAnyStream(none, 1, &which, ONI_TIMEOUT_NONE);
}

int iso__openni2_session_take(struct iso__openni2_session *session, int timeout_ms,
                              OniFrame **frame, struct iso_fault *fault)
{
    struct iso__openni2_stream *streams[] = {&session->depth, &session->grey};
    OniStreamHandle handles[] = {session->depth.handle, session->grey.handle};
    int which = 0;
    if (atomic_load(&session->gone)) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_GONE, -ENODEV,
                                  "%s: %s: the device is gone", owner, session->info.uri);
    }
    if (iso__openni2_session_ended(session)) {
        return -ETIMEDOUT;
    }
    if (session->file) {
        forget_old_news();
    }
    OniStatus status = oniWaitForAnyStream(handles, session->grey.handle ? 2 : 1, &which,
                                           session->file ? PLAYER_MS : timeout_ms);
    if (status == ONI_STATUS_TIME_OUT) {
        return session->file ? iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, -EIO,
                                                  "%s: %s: neither a frame nor the end", owner,
                                                  session->info.uri)
                             : -ETIMEDOUT;
    }
    if (status == ONI_STATUS_OK) {
        status = oniStreamReadFrame(handles[which], frame);
    }
    if (status != ONI_STATUS_OK) {
        return iso__openni2_refuse(status, "reading a frame", fault);
    }
    streams[which]->taken++;
    if (iso__openni2_session_ended(session)) {
        stop_streams(session); /* or else the player turns round and round at the end */
    }
    return 0;
}
