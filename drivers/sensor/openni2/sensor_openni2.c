#include "drivers/sensor/openni2/sensor_openni2.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sensor/contract/timeline.h"
#include "drivers/sensor/openni2/openni2_frame.h"
#include "drivers/sensor/openni2/openni2_options.h"
#include "drivers/sensor/openni2/openni2_pairing.h"
#include "drivers/sensor/openni2/openni2_runtime.h"
#include "drivers/sensor/openni2/openni2_session.h"

static const char owner[] = "sensor openni2";

enum {
    SLICE_MS = 20,     /* longest sleep between two checks whether the device is there */
    AFTER_END_MS = 50, /* delay before a file that has ended is checked again */
    NS_PER_MS = 1000000,
    LOOP_GAP_NS = 33333333, /* time between the last frame of a file and its first one */
};

struct openni2 {
    struct iso_clock clock;
    struct iso__openni2_settings settings;
    struct iso__openni2_session session;
    struct iso_frame *frame;
    struct iso__openni2_pairing fetched; /* fetched, but not yet handed to the caller */
    bool played;                         /* the file is no longer at its beginning */

    struct iso_timeline timeline; /* gives the sequence; the time only for a device */
    /* Of a file: the clock time of its time 0, the file's time of the last frame, and the clock
     * time at which that frame is due. */
    int64_t origin_ns, file_ns, last_ns;
    int64_t interval_ns, handed_ns; /* of the frames that are wanted; the time of the last one */
};

/* ---- opening and closing ---------------------------------------------------- */

static int make_frame(struct openni2 *sensor, struct iso_fault *fault)
{
    struct iso_camera camera = sensor->session.camera;
    const struct iso__openni2_settings *settings = &sensor->settings;
    const struct iso_camera *measured = &settings->camera.meta.camera;
    struct iso_fault why;
    if (settings->has_camera &&
        (measured->width_px != camera.width_px || measured->height_px != camera.height_px)) {
        return iso_fault_set_code(fault, ISO_FAULT_CALIBRATION_WRONG, -EINVAL,
                                  "%s: the camera gives %d x %d, %s is for %d x %d", owner,
                                  camera.width_px, camera.height_px, settings->camera.name,
                                  measured->width_px, measured->height_px);
    }
    if (settings->has_camera) {
        camera = *measured;
    } else if (settings->calibrated) {
        camera.fx_px = settings->lens.fx_px;
        camera.fy_px = settings->lens.fy_px;
        camera.cx_px = settings->lens.cx_px;
        camera.cy_px = settings->lens.cy_px;
    }
    if (iso_camera_check(&camera, &why)) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: option 'intrinsics': %s", owner, why.text);
    }
    const int error = iso_frame_new(&camera, camera.width_px, camera.height_px,
                                    sensor->session.grey.handle != NULL, &sensor->frame);
    return error ? iso_fault_set(fault, error, "%s: out of memory", owner) : 0;
}

static void openni2_close(void *self)
{
    struct openni2 *sensor = self;
    iso__openni2_pairing_clear(&sensor->fetched);
    iso__openni2_session_close(&sensor->session);
    iso_frame_free(sensor->frame);
    iso__openni2_settings_done(&sensor->settings);
    free(sensor);
}

static int openni2_check(const struct iso_option *options, size_t n_options,
                         struct iso_fault *fault)
{
    struct iso__openni2_settings settings;
    const int error = iso__openni2_settings_init(&settings, options, n_options, fault);
    iso__openni2_settings_done(&settings);
    return error;
}

static int openni2_open(const struct iso_option *options, size_t n_options,
                        const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    struct openni2 *sensor = calloc(1, sizeof *sensor);
    if (!sensor) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    sensor->clock = *clock;
    sensor->last_ns = INT64_MIN;
    int error = iso__openni2_settings_init(&sensor->settings, options, n_options, fault);
    if (!error) {
        error = iso__openni2_session_open(&sensor->session, &sensor->settings.wish, fault);
    }
    if (!error) {
        error = make_frame(sensor, fault);
    }
    if (error) {
        openni2_close(sensor);
        return error;
    }
    *self = sensor;
    return 0;
}

/* Starting again would continue a file where it was stopped. The file is therefore opened again, to
 * play it from its beginning. */
static int rewind_file(struct openni2 *sensor, struct iso_fault *fault)
{
    if (!sensor->session.file || !sensor->played) {
        return 0;
    }
    iso__openni2_session_close(&sensor->session);
    sensor->played = false;
    return iso__openni2_session_open(&sensor->session, &sensor->settings.wish, fault);
}

static void openni2_set_interval(void *self, int64_t interval_ns)
{
    struct openni2 *sensor = self;
    sensor->interval_ns = interval_ns;
    sensor->timeline.gapless = interval_ns > 0; /* the runtime keeps the newest frame only */
}

static int openni2_start(void *self, struct iso_fault *fault)
{
    struct openni2 *sensor = self;
    int error = rewind_file(sensor, fault);
    if (!error) {
        error = iso__openni2_session_start(&sensor->session, sensor->settings.record, fault);
    }
    sensor->file_ns = INT64_MIN;
    openni2_set_interval(sensor, 0);
    iso_timeline_restart(&sensor->timeline);
    return error;
}

static int openni2_stop(void *self)
{
    struct openni2 *sensor = self;
    iso__openni2_session_stop(&sensor->session);
    iso__openni2_pairing_clear(&sensor->fetched);
    return 0;
}

/* ---- fetching --------------------------------------------------------------- */

static bool is_complete(struct openni2 *sensor)
{
    return iso__openni2_pairing_complete(&sensor->fetched, sensor->session.grey.handle != NULL,
                                         sensor->session.depth.mode.fps);
}

static int take_one(struct openni2 *sensor, int timeout_ms, struct iso_fault *fault)
{
    OniFrame *taken = NULL;
    const int error = iso__openni2_session_take(&sensor->session, timeout_ms, &taken, fault);
    if (!error) {
        sensor->played = true;
        iso__openni2_pairing_add(&sensor->fetched, taken);
    }
    return error;
}

/* For a device: fetches until a frame is complete or the deadline has passed. The remaining time is
 * also reduced by the duration of the waits, so that a clock that does not advance cannot block the
 * caller. */
static int fetch_live(struct openni2 *sensor, int64_t deadline_ns, struct iso_fault *fault)
{
    const int64_t left_ns = deadline_ns - iso_clock_now_ns(&sensor->clock);
    int64_t left_ms = left_ns <= 0 ? 0 : (left_ns - 1) / NS_PER_MS + 1;
    while (!is_complete(sensor)) {
        const int slice_ms = left_ms < SLICE_MS ? (int)left_ms : SLICE_MS;
        const int error = take_one(sensor, slice_ms, fault);
        if (error && error != -ETIMEDOUT) {
            return error;
        }
        if (atomic_load(&sensor->session.state) == ONI_DEVICE_STATE_ERROR) {
            return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, -EIO,
                                      "%s: %s: the device reports an error", owner,
                                      sensor->session.info.uri);
        }
        if (error) {
            left_ms -= slice_ms;
            if (left_ms <= 0 || iso_clock_now_ns(&sensor->clock) >= deadline_ns) {
                return -ETIMEDOUT;
            }
        }
    }
    return 0;
}

/* For a file: fetches the next frame, which takes only the time to read it. */
static int fetch_file(struct openni2 *sensor, struct iso_fault *fault)
{
    int error = 0;
    while (!error && !is_complete(sensor)) {
        error = take_one(sensor, 0, fault);
    }
    return error;
}

/* ---- handing up ------------------------------------------------------------- */

/* The time at which the fetched frame of a file is due. */
static int64_t file_due_ns(struct openni2 *sensor)
{
    const int64_t t_ns = iso__openni2_frame_ns(sensor->fetched.depth),
                  now_ns = iso_clock_now_ns(&sensor->clock);
    if (sensor->file_ns == INT64_MIN) {
        /* This is the first frame. */
        sensor->origin_ns = now_ns - t_ns;
    } else if (t_ns <= sensor->file_ns) {
        /* The file has begun again. */
        sensor->origin_ns += sensor->file_ns - t_ns + LOOP_GAP_NS;
    }
    sensor->file_ns = t_ns;
    const int64_t due_ns = sensor->settings.realtime ? sensor->origin_ns + t_ns : now_ns;
    return due_ns > sensor->last_ns ? due_ns : sensor->last_ns + 1;
}

static int convert_frames(struct openni2 *sensor, struct iso_fault *fault)
{
    const struct iso__openni2_session *session = &sensor->session;
    const char *part = "depth";
    struct iso_fault why;
    int error = iso__openni2_read_depth(sensor->fetched.depth, session->depth.mirrored,
                                        sensor->frame, &why);
    if (!error && session->grey.handle) {
        part = "intensity";
        error = iso__openni2_read_intensity(sensor->fetched.grey, session->grey.mirrored,
                                            session->grey.full_scale, sensor->frame, &why);
    }
    return error ? iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, error,
                                      "%s: %s: frame %d: %s %s", owner, session->info.uri,
                                      sensor->fetched.depth->frameIndex, part, why.text)
                 : 0;
}

/* Returns -EAGAIN if the frame is passed over: the next one then follows the one before it. */
static int hand_up(struct openni2 *sensor, const struct iso_frame **frame, struct iso_fault *fault)
{
    iso_timeline_advance(&sensor->timeline, sensor->fetched.depth->frameIndex,
                         iso__openni2_frame_ns(sensor->fetched.depth),
                         iso_clock_now_ns(&sensor->clock));
    const int64_t t_ns = sensor->session.file ? sensor->last_ns : sensor->timeline.t_ns;
    /* A file that is played at once has no times of its own, so every frame of it is wanted. */
    const bool timed = !sensor->session.file || sensor->settings.realtime;
    if (timed && sensor->interval_ns > 0 && t_ns - sensor->handed_ns < sensor->interval_ns) {
        sensor->timeline.sequence--;
        iso__openni2_pairing_clear(&sensor->fetched);
        return -EAGAIN;
    }
    sensor->handed_ns = t_ns;
    const int error = convert_frames(sensor, fault);
    sensor->frame->t_ns = t_ns;
    sensor->frame->sequence = sensor->timeline.sequence;
    iso__openni2_pairing_clear(&sensor->fetched);
    if (!error) {
        *frame = sensor->frame;
    }
    return error;
}

static int wait_file(struct openni2 *sensor, const struct iso_frame **frame,
                     struct iso_fault *fault)
{
    const bool fresh = !sensor->fetched.depth;
    const int error = fetch_file(sensor, fault);
    if (error) {
        return error;
    }
    if (fresh) {
        sensor->last_ns = file_due_ns(sensor);
    }
    if (sensor->settings.realtime && iso_clock_now_ns(&sensor->clock) < sensor->last_ns) {
        return -ETIMEDOUT;
    }
    const int handed = hand_up(sensor, frame, fault);
    return handed == -EAGAIN ? -ETIMEDOUT : handed;
}

static int openni2_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                        struct iso_fault *fault)
{
    struct openni2 *sensor = self;
    if (sensor->session.file) {
        return wait_file(sensor, frame, fault);
    }
    int error;
    do {
        error = fetch_live(sensor, deadline_ns, fault);
        error = error ? error : hand_up(sensor, frame, fault);
    } while (error == -EAGAIN);
    return error;
}

/* Only the frames of a file have a time at which they are due. The wait for a device blocks. */
static int openni2_next_due_ns(void *self, int64_t *out)
{
    struct openni2 *sensor = self;
    if (!sensor->session.file) {
        return -ENOSYS;
    }
    const int64_t now_ns = iso_clock_now_ns(&sensor->clock);
    const bool waits = sensor->fetched.depth && sensor->last_ns > now_ns;
    const bool ended = !waits && iso__openni2_session_ended(&sensor->session);
    *out = waits ? sensor->last_ns : now_ns + (ended ? (int64_t)AFTER_END_MS * NS_PER_MS : 0);
    return 0;
}

/* ---- description and health ---------------------------------------------------- */

/* Makes a name for the device that a recording accepts. */
static void name_model(const char *name, char *model, size_t size)
{
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    size_t n = 0;
    for (; name[n] && n + 1 < size; n++) {
        model[n] = name[n];
        if (!strchr(allowed, name[n])) {
            model[n] = '-';
        }
    }
    model[n] = '\0';
    if (n == 0) {
        (void)snprintf(model, size, "openni2");
    }
}

static int openni2_describe(void *self, struct iso_sensor_description *out)
{
    const struct openni2 *sensor = self;
    const struct iso__openni2_session *session = &sensor->session;
    *out = (struct iso_sensor_description){
        .width_px = session->camera.width_px,
        .height_px = session->camera.height_px,
        .intensity = session->grey.handle != NULL,
        .unit_mm = iso__openni2_unit_mm(session->depth.mode.pixelFormat),
        .rate_hz = session->depth.mode.fps,
    };
    name_model(session->info.name, out->model, sizeof out->model);
    (void)snprintf(out->serial, sizeof out->serial, "%s", session->serial);
    if (sensor->settings.has_camera) {
        iso_camera_file_describe(&sensor->settings.camera, out->calibration,
                                 sizeof out->calibration);
        out->calibration_code = sensor->settings.camera.meta.nominal ? ISO_FAULT_CALIBRATION_NOMINAL
                                                                     : ISO_FAULT_NONE;
    }
    return 0;
}

static void openni2_health(void *self, struct iso_sensor_device_health *out)
{
    static const char *const words[] = {"", "error", "not ready",
                                        "" /* the end of a file is not a fault */};
    const int n_words = (int)(sizeof words / sizeof *words);
    struct openni2 *sensor = self;
    const int state = atomic_load(&sensor->session.state);
    const char *word = state >= 0 && state < n_words ? words[state] : "unknown state";
    out->dropped = sensor->fetched.dropped;
    out->code = *word ? ISO_FAULT_SENSOR_FAILED : ISO_FAULT_NONE;
    if (atomic_load(&sensor->session.gone)) {
        word = "unplugged";
        out->code = ISO_FAULT_SENSOR_GONE;
    }
    (void)snprintf(out->state, sizeof out->state, "%s", word);
}

void iso_sensor_openni2_forget(void)
{
    iso__openni2_leave();
}

const struct iso_sensor_ops iso_sensor_openni2_ops = {
    .name = "openni2",
    .options = iso__openni2_options,
    .probe = iso__openni2_probe,
    .check = openni2_check,
    .open = openni2_open,
    .start = openni2_start,
    .wait = openni2_wait,
    .next_due_ns = openni2_next_due_ns,
    .set_interval = openni2_set_interval,
    .describe = openni2_describe,
    .health = openni2_health,
    .stop = openni2_stop,
    .close = openni2_close,
};
