#include "drivers/sensor/openni2/openni2_session.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "drivers/sensor/openni2/openni2_runtime.h"
#include "drivers/sensor/openni2/openni2_stream.h"

static const char owner[] = "sensor openni2";

enum {
    PLAYER_MS = 2000, /* a file that gives no frame for this time is stuck */
    RECORDER_LOOK_MS = 20,
    RECORDER_STILL = 3,  /* after so many looks without a change the recorder is ready */
    RECORDER_LOOKS = 50, /* the largest number of looks */
};

/* ---- events of the device --------------------------------------------------- */

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

static int watch_device(struct iso__openni2_session *session, struct iso_fault *fault)
{
    OniDeviceCallbacks callbacks = {
        .deviceDisconnected = on_disconnected,
        .deviceStateChanged = on_state,
    };
    const OniStatus status = oniRegisterDeviceCallbacks(&callbacks, session, &session->watch);
    return status == ONI_STATUS_OK ? 0 : iso__openni2_refuse(status, "cannot be watched", fault);
}

/* ---- opening and closing ---------------------------------------------------- */

/* Sets the playback of a file so that it gives each frame only when it is asked for. */
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
    struct iso__openni2_threads before;
    iso__openni2_threads_list(&before);
    const OniStatus status = oniDeviceOpen(session->info.uri, &session->device);
    iso__openni2_threads_new(&before, &session->player);
    if (status != ONI_STATUS_OK) {
        session->device = NULL;
        return iso__openni2_refuse(status, session->info.uri, fault);
    }
    (void)oniDeviceGetInfo(session->device, &session->info);
    iso__openni2_read_serial(session->device, session->serial);
    int error = session->file ? set_playback(session, fault) : 0;
    if (!error) {
        error = iso__openni2_claim_depth(session, wish, fault);
    }
    if (!error && wish->grey != ISO__OPENNI2_NO_GREY) {
        error = iso__openni2_claim_grey(session, wish->grey, fault);
    }
    if (!error) {
        error = iso__openni2_find_camera(session, wish->grey, fault);
    }
    return error;
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
    if (!error) {
        error = watch_device(session, fault);
    }
    if (!error) {
        error = open_device(session, wish, fault);
    }
    session->opened = !error;
    if (error == -ENODEV) {
        iso__openni2_stay();
    }
    if (error) {
        iso__openni2_session_close(session);
    }
    return error;
}

static void destroy_stream(const struct iso__openni2_session *session,
                           const struct iso__openni2_stream *stream)
{
    if (!stream->handle) {
        return;
    }
    if (session->file) {
        iso__openni2_threads_await_sleep(&session->player);
    }
    oniStreamDestroy(stream->handle);
}

void iso__openni2_session_close(struct iso__openni2_session *session)
{
    iso__openni2_session_stop(session);
    destroy_stream(session, &session->grey);
    destroy_stream(session, &session->depth);
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

/* The recorder starts in a thread of its own, and silently drops frames that arrive before that. It
 * writes the streams' properties first. When its file has stopped growing, it has started. */
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

/* Called when the streams run. A recorder counts the time of each stream from that stream's first
 * frame, so the first frames of depth and intensity must be of the same exposure. */
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
    if (atomic_load(&session->gone)) {
        /* The runtime reports no error if it starts a device that is gone. */
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

/* oniWaitForAnyStream must look for a frame only once: each time it looks, the player reads a
 * frame, and a frame that is not fetched is overwritten by the next one. A frame that came between
 * two waits has left the thread's event set, so the runtime would look twice. Waiting for no stream
 * clears the event. */
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
                                                  "%s: %s: no frame and no end of the file", owner,
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
        stop_streams(session); /* otherwise the player loops without a pause at the end */
    }
    return 0;
}
