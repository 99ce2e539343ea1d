#include "drivers/sensor/openni2/sensor_openni2.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sensor/contract/camera_file.h"
#include "drivers/sensor/contract/timeline.h"
#include "drivers/sensor/openni2/openni2_frame.h"
#include "drivers/sensor/openni2/openni2_runtime.h"
#include "drivers/sensor/openni2/openni2_session.h"

static const char owner[] = "sensor openni2";

enum {
    SLICE_MS = 20,     /* longest sleep between two looks at whether the device is there */
    AFTER_END_MS = 50, /* when to look at a file again that has ended */
    NS_PER_MS = 1000000,
    LOOP_GAP_NS = 33333333, /* from the last frame of a file to its first */
};

struct openni2 {
    struct iso_clock clock;
    struct iso__openni2_wish wish;
    char *path, *device, *record; /* what the wish points to */
    bool realtime;                /* of a file */
    bool calibrated;              /* by the option `intrinsics`: */
    double fx_px, fy_px, cx_px, cy_px;
    bool has_camera; /* by the option `camera`: */
    struct iso_camera_file camera;

    struct iso__openni2_session session;
    struct iso_frame *frame;
    OniFrame *depth, *grey; /* fetched and not yet handed up; NULL: none */
    bool played;            /* the file is not at its beginning */
    uint64_t dropped;

    struct iso_timeline timeline;        /* of a device */
    int64_t origin_ns, file_ns, last_ns; /* of a file: clock time of its time 0, its last time */
};

/* ---- options ---------------------------------------------------------------- */

static int read_mode(const char *text, struct iso__openni2_wish *wish)
{
    int end = -1;
    const int n = sscanf(text, "%5dx%5d@%5d%n", &wish->width_px, &wish->height_px, &wish->fps,
                         &end);
    const bool whole = n == 3 && end >= 0 && !text[end];
    return whole && wish->width_px >= 1 && wish->height_px >= 1 && wish->fps >= 1 ? 0 : -EINVAL;
}

static int check_mode(const char *value, struct iso_fault *fault)
{
    struct iso__openni2_wish wish;
    return read_mode(value, &wish) ? iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                                        "'%s' is not WIDTHxHEIGHT@HZ", value)
                                   : 0;
}

static int read_intrinsics(const char *text, struct iso_camera *camera)
{
    int end = -1;
    const int n = sscanf(text, "%lf %lf %lf %lf%n", &camera->fx_px, &camera->fy_px, &camera->cx_px,
                         &camera->cy_px, &end);
    return n == 4 && end >= 0 && !text[end] ? 0 : -EINVAL;
}

/* As far as that can be told before the size of the pictures is known. */
static int check_intrinsics(const char *value, struct iso_fault *fault)
{
    struct iso_camera largest = {.projection = ISO_PINHOLE, .width_px = 8192, .height_px = 8192};
    const char *what = NULL;
    if (read_intrinsics(value, &largest)) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL, "'%s' is not FX FY CX CY",
                                  value);
    }
    return iso_camera_check(&largest, &what)
               ? iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL, "%s", what)
               : 0;
}

static const struct iso_option_spec option_specs[] = {
    {.name = "device",
     .standard = "",
     .help = "URI or serial number of the camera; the first camera if empty"},
    {.name = "path",
     .kind = ISO_OPTION_PATH,
     .standard = "",
     .help = "an .oni file to play instead of a camera"},
    {.name = "mode",
     .standard = "",
     .check = check_mode,
     .help = "WIDTHxHEIGHT@HZ; as the camera has it if empty"},
    {.name = "unit",
     .kind = ISO_OPTION_CHOICE,
     .choices = "finest|100um|1mm",
     .standard = "finest",
     .help = "the length that a count of depth stands for"},
    {.name = "intensity",
     .kind = ISO_OPTION_CHOICE,
     .choices = "no|ir|color",
     .standard = "no",
     .help = "which image comes with the depths"},
    {.name = "intrinsics",
     .standard = "",
     .check = check_intrinsics,
     .help = "FX FY CX CY in pixels, from a calibration, instead of a camera file"},
    {.name = "camera",
     .kind = ISO_OPTION_PATH,
     .standard = "",
     .help = "a file like recording.ini that describes the lens of the depth camera"},
    {.name = "pace",
     .kind = ISO_OPTION_CHOICE,
     .choices = "realtime|asap",
     .standard = "realtime",
     .help = "of an .oni file: when frames are due, by their time stamps or at once"},
    {.name = "loop",
     .kind = ISO_OPTION_SWITCH,
     .standard = "no",
     .help = "of an .oni file: whether the first frame follows the last one"},
    {.name = "record",
     .kind = ISO_OPTION_PATH,
     .standard = "",
     .tools_only = true,
     .help = "an .oni file that OpenNI 2 writes from start to stop"},
    {.name = NULL},
};

static int parse_words(const struct iso_option_set *set, struct openni2 *sensor,
                       struct iso_fault *fault)
{
    static const int unit_um[] = {0, 100, 1000};
    struct iso__openni2_wish *wish = &sensor->wish;
    struct iso_camera lens = {.fx_px = 0.0};
    const char *mode = iso_option_text(set, "mode");
    const char *intrinsics = iso_option_text(set, "intrinsics");
    wish->unit_um = unit_um[iso_option_choice(set, "unit")];
    wish->grey = (enum iso__openni2_grey)iso_option_choice(set, "intensity");
    wish->loop = iso_option_switch(set, "loop");
    sensor->realtime = iso_option_choice(set, "pace") == 0;
    sensor->calibrated = *intrinsics;
    if ((*mode && read_mode(mode, wish)) ||
        (sensor->calibrated && read_intrinsics(intrinsics, &lens))) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: bad mode or intrinsics", owner);
    }
    sensor->fx_px = lens.fx_px;
    sensor->fy_px = lens.fy_px;
    sensor->cx_px = lens.cx_px;
    sensor->cy_px = lens.cy_px;
    return 0;
}

static int parse_camera(const struct iso_option_set *set, struct openni2 *sensor,
                        struct iso_fault *fault)
{
    if (!iso_option_is_given(set, "camera")) {
        return 0;
    }
    if (sensor->calibrated) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: options 'camera' and 'intrinsics' exclude each other",
                                  owner);
    }
    sensor->has_camera = true;
    return iso_camera_file_read(iso_option_text(set, "camera"), &sensor->camera, fault);
}

static int copy_text(const struct iso_option_set *set, const char *name, char **out,
                     struct iso_fault *fault)
{
    if (!iso_option_is_given(set, name)) {
        return 0;
    }
    *out = strdup(iso_option_text(set, name));
    return *out ? 0 : iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
}

static void free_options(struct openni2 *sensor)
{
    free(sensor->path);
    free(sensor->device);
    free(sensor->record);
}

static int parse_options(const struct iso_option *options, size_t n, struct openni2 *sensor,
                         struct iso_fault *fault)
{
    const struct iso_option_set set = {option_specs, options, n};
    int error = parse_words(&set, sensor, fault);
    error = error ? error : parse_camera(&set, sensor, fault);
    error = error ? error : copy_text(&set, "path", &sensor->path, fault);
    error = error ? error : copy_text(&set, "device", &sensor->device, fault);
    error = error ? error : copy_text(&set, "record", &sensor->record, fault);
    if (error) {
        return error;
    }
    if (sensor->path && sensor->device) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: options 'path' and 'device' exclude each other", owner);
    }
    if (!sensor->path && (!sensor->realtime || sensor->wish.loop)) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: options 'pace' and 'loop' are of a file ('path')", owner);
    }
    sensor->wish.path = sensor->path;
    sensor->wish.device = sensor->device;
    return 0;
}

/* ---- opening and closing ---------------------------------------------------- */

static void drop(OniFrame **frame)
{
    if (*frame) {
        oniFrameRelease(*frame);
        *frame = NULL;
    }
}

static int make_frame(struct openni2 *sensor, struct iso_fault *fault)
{
    struct iso_camera camera = sensor->session.camera;
    const struct iso_camera *measured = &sensor->camera.meta.camera;
    const char *what = NULL;
    if (sensor->has_camera &&
        (measured->width_px != camera.width_px || measured->height_px != camera.height_px)) {
        return iso_fault_set_code(fault, ISO_FAULT_CALIBRATION_WRONG, -EINVAL,
                                  "%s: the camera gives %d x %d, %s is for %d x %d", owner,
                                  camera.width_px, camera.height_px, sensor->camera.name,
                                  measured->width_px, measured->height_px);
    }
    camera = sensor->has_camera ? *measured : camera;
    if (sensor->calibrated) {
        camera.fx_px = sensor->fx_px;
        camera.fy_px = sensor->fy_px;
        camera.cx_px = sensor->cx_px;
        camera.cy_px = sensor->cy_px;
    }
    if (iso_camera_check(&camera, &what)) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: option 'intrinsics': %s", owner, what);
    }
    const int error = iso_frame_new(&camera, camera.width_px, camera.height_px,
                                    sensor->session.grey.handle != NULL, &sensor->frame);
    return error ? iso_fault_set(fault, error, "%s: out of memory", owner) : 0;
}

static void openni2_close(void *self)
{
    struct openni2 *sensor = self;
    drop(&sensor->depth);
    drop(&sensor->grey);
    iso__openni2_session_close(&sensor->session);
    iso_frame_free(sensor->frame);
    free_options(sensor);
    free(sensor);
}

static int openni2_check(const struct iso_option *options, size_t n_options,
                         struct iso_fault *fault)
{
    struct openni2 sensor = {.path = NULL};
    const int error = parse_options(options, n_options, &sensor, fault);
    free_options(&sensor);
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
    int error = parse_options(options, n_options, sensor, fault);
    error = error ? error : iso__openni2_session_open(&sensor->session, &sensor->wish, fault);
    error = error ? error : make_frame(sensor, fault);
    if (error) {
        openni2_close(sensor);
        return error;
    }
    *self = sensor;
    return 0;
}

/* A file goes on where it was, and from its end nowhere: it is opened anew. */
static int rewind_file(struct openni2 *sensor, struct iso_fault *fault)
{
    if (!sensor->session.file || !sensor->played) {
        return 0;
    }
    iso__openni2_session_close(&sensor->session);
    sensor->played = false;
    return iso__openni2_session_open(&sensor->session, &sensor->wish, fault);
}

static int openni2_start(void *self, struct iso_fault *fault)
{
    struct openni2 *sensor = self;
    int error = rewind_file(sensor, fault);
    if (!error) {
        error = iso__openni2_session_start(&sensor->session, sensor->record, fault);
    }
    sensor->file_ns = INT64_MIN;
    iso_timeline_restart(&sensor->timeline);
    return error;
}

static int openni2_stop(void *self)
{
    struct openni2 *sensor = self;
    iso__openni2_session_stop(&sensor->session);
    drop(&sensor->depth);
    drop(&sensor->grey);
    return 0;
}

/* ---- fetching --------------------------------------------------------------- */

static int64_t frame_ns(const OniFrame *frame)
{
    return (int64_t)frame->timestamp * 1000;
}

/* Puts a frame where it belongs. The runtime hands out older frames first. */
static void place(struct openni2 *sensor, OniFrame *frame)
{
    if (frame->sensorType != ONI_SENSOR_DEPTH) {
        drop(&sensor->grey);
        sensor->grey = frame;
        return;
    }
    if (sensor->depth) {
        sensor->dropped++;
        drop(&sensor->depth);
    }
    sensor->depth = frame;
}

/* Whether a frame is complete; parts that can no longer find their partner are dropped. */
static bool is_complete(struct openni2 *sensor)
{
    if (!sensor->session.grey.handle) {
        return sensor->depth != NULL;
    }
    if (!sensor->depth || !sensor->grey) {
        return false;
    }
    const int64_t half_ns = INT64_C(500000000) / sensor->session.depth.mode.fps;
    const int64_t ahead_ns = frame_ns(sensor->grey) - frame_ns(sensor->depth);
    if (ahead_ns > half_ns) {
        sensor->dropped++;
        drop(&sensor->depth);
    } else if (ahead_ns < -half_ns) {
        drop(&sensor->grey);
    }
    return sensor->depth && sensor->grey;
}

static int take_one(struct openni2 *sensor, int timeout_ms, struct iso_fault *fault)
{
    OniFrame *taken = NULL;
    const int error = iso__openni2_session_take(&sensor->session, timeout_ms, &taken, fault);
    if (!error) {
        sensor->played = true;
        place(sensor, taken);
    }
    return error;
}

/* Of a device: fetches until a frame is complete or the deadline has come. The time left is counted
 * down by what was slept: a clock that stands still must not hold the caller. */
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

/* Of a file: fetches the next frame, which takes the player no more than it takes to read it. */
static int fetch_file(struct openni2 *sensor, struct iso_fault *fault)
{
    int error = 0;
    while (!error && !is_complete(sensor)) {
        error = take_one(sensor, 0, fault);
    }
    return error;
}

/* ---- handing up ------------------------------------------------------------- */

/* When the fetched frame of a file is due. */
static int64_t file_due_ns(struct openni2 *sensor)
{
    const int64_t t_ns = frame_ns(sensor->depth), now_ns = iso_clock_now_ns(&sensor->clock);
    if (sensor->file_ns == INT64_MIN) { /* the first one */
        sensor->origin_ns = now_ns - t_ns;
    } else if (t_ns <= sensor->file_ns) { /* it began again */
        sensor->origin_ns += sensor->file_ns - t_ns + LOOP_GAP_NS;
    }
    sensor->file_ns = t_ns;
    const int64_t due_ns = sensor->realtime ? sensor->origin_ns + t_ns : now_ns;
    return due_ns > sensor->last_ns ? due_ns : sensor->last_ns + 1;
}

static int convert(struct openni2 *sensor, struct iso_fault *fault)
{
    const struct iso__openni2_session *session = &sensor->session;
    const char *what = "", *part = "depth";
    int error = iso__openni2_read_depth(sensor->depth, session->depth.mirrored, sensor->frame,
                                        &what);
    if (!error && session->grey.handle) {
        part = "intensity";
        error = iso__openni2_read_intensity(sensor->grey, session->grey.mirrored,
                                            session->grey.full_scale, sensor->frame, &what);
    }
    return error ? iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, error,
                                      "%s: %s: frame %d: %s %s", owner, session->info.uri,
                                      sensor->depth->frameIndex, part, what)
                 : 0;
}

static int hand_up(struct openni2 *sensor, const struct iso_frame **frame, struct iso_fault *fault)
{
    const int64_t now_ns = iso_clock_now_ns(&sensor->clock);
    const int index = sensor->depth->frameIndex;
    iso_timeline_advance(&sensor->timeline, index, frame_ns(sensor->depth), now_ns);
    const int error = convert(sensor, fault);
    sensor->frame->t_ns = sensor->session.file ? sensor->last_ns : sensor->timeline.t_ns;
    sensor->frame->sequence = sensor->timeline.sequence;
    drop(&sensor->depth);
    drop(&sensor->grey);
    if (!error) {
        *frame = sensor->frame;
    }
    return error;
}

static int wait_file(struct openni2 *sensor, const struct iso_frame **frame,
                     struct iso_fault *fault)
{
    const bool fresh = !sensor->depth;
    int error = fetch_file(sensor, fault);
    if (error) {
        return error;
    }
    if (fresh) {
        sensor->last_ns = file_due_ns(sensor);
    }
    if (sensor->realtime && iso_clock_now_ns(&sensor->clock) < sensor->last_ns) {
        return -ETIMEDOUT;
    }
    return hand_up(sensor, frame, fault);
}

static int openni2_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                        struct iso_fault *fault)
{
    struct openni2 *sensor = self;
    if (sensor->session.file) {
        return wait_file(sensor, frame, fault);
    }
    const int error = fetch_live(sensor, deadline_ns, fault);
    return error ? error : hand_up(sensor, frame, fault);
}

/* Of a file alone: a device is waited for. */
static int openni2_next_due_ns(void *self, int64_t *out)
{
    struct openni2 *sensor = self;
    if (!sensor->session.file) {
        return -ENOSYS;
    }
    const int64_t now_ns = iso_clock_now_ns(&sensor->clock);
    if (sensor->depth && sensor->last_ns > now_ns) {
        *out = sensor->last_ns;
    } else {
        const bool ended = iso__openni2_session_ended(&sensor->session);
        *out = ended ? now_ns + (int64_t)AFTER_END_MS * NS_PER_MS : now_ns;
    }
    return 0;
}

/* ---- what is known of it ---------------------------------------------------- */

/* A device's name as a recording can hold it. */
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
    if (sensor->has_camera) {
        iso_camera_file_describe(&sensor->camera, out->calibration, sizeof out->calibration);
        out->calibration_code = sensor->camera.meta.nominal ? ISO_FAULT_CALIBRATION_NOMINAL
                                                            : ISO_FAULT_NONE;
    }
    return 0;
}

static void openni2_health(void *self, struct iso_sensor_device_health *out)
{
    struct openni2 *sensor = self;
    static const char *const words[] = {"", "error", "not ready",
                                        "" /* a file's end is no fault */};
    const int state = atomic_load(&sensor->session.state);
    const bool known = state >= 0 && state < (int)(sizeof words / sizeof *words);
    const char *word = atomic_load(&sensor->session.gone) ? "unplugged" : "unknown state";
    out->dropped = sensor->dropped;
    (void)snprintf(out->state, sizeof out->state, "%s",
                   known && !atomic_load(&sensor->session.gone) ? words[state] : word);
    out->code = atomic_load(&sensor->session.gone) ? ISO_FAULT_SENSOR_GONE
                : out->state[0]                    ? ISO_FAULT_SENSOR_FAILED
                                                   : ISO_FAULT_NONE;
}

void iso_sensor_openni2_forget(void)
{
    iso__openni2_leave();
}

const struct iso_sensor_ops iso_sensor_openni2_ops = {
    .name = "openni2",
    .options = option_specs,
    .probe = iso__openni2_probe,
    .check = openni2_check,
    .open = openni2_open,
    .start = openni2_start,
    .wait = openni2_wait,
    .next_due_ns = openni2_next_due_ns,
    .describe = openni2_describe,
    .health = openni2_health,
    .stop = openni2_stop,
    .close = openni2_close,
};
