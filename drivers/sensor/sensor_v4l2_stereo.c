#include "drivers/sensor/sensor_v4l2_stereo.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sensor/picture_format.h"
#include "drivers/sensor/picture_stream.h"
#include "drivers/sensor/sensor_stereo.h"
#include "drivers/sensor/sensor_v4l2_node.h"

static const char owner[] = "sensor v4l2-stereo";

struct pair {
    struct iso_sensor_stereo stereo;
    struct iso_v4l2_node *nodes[ISO_EYES];
    struct iso_picture_stream *stream;
};

static int read_options(const struct iso_option *options, size_t n_options,
                        struct iso_v4l2_wish wishes[ISO_EYES], int64_t *tolerance_ns,
                        struct iso_fault *fault)
{
    static const char *const known[] = {"left",    "right",  "calibration", "fps", "pair_ms",
                                        "near_mm", "far_mm", "confidence",  NULL};
    static const char *const eyes[ISO_EYES] = {"left", "right"};
    double fps = 0.0, pair_ms = 0.0;
    int error = iso_options_check(owner, options, n_options, known, fault);
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        struct iso_v4l2_wish *wish = &wishes[eye];
        wish->owner = owner;
        memcpy(wish->formats, iso_picture_grey_formats, sizeof iso_picture_grey_formats);
        error = iso_options_required(owner, options, n_options, eyes[eye], &wish->path, fault);
    }
    error = error ? error
                  : iso_options_number(owner, options, n_options, "fps", 1.0, 1000.0, 0.0, &fps,
                                       fault);
    error = error ? error
                  : iso_options_number(owner, options, n_options, "pair_ms", 0.1, 1000.0, 4.0,
                                       &pair_ms, fault);
    wishes[0].fps = wishes[1].fps = (int)fps;
    *tolerance_ns = (int64_t)(pair_ms * 1e6);
    return error;
}

static void pair_close(void *self)
{
    struct pair *pair = self;
    iso_picture_stream_close(pair->stream);
    iso_v4l2_node_close(pair->nodes[ISO_EYE_LEFT]);
    iso_v4l2_node_close(pair->nodes[ISO_EYE_RIGHT]);
    iso_sensor_stereo_done(&pair->stereo);
    free(pair);
}

int iso_sensor_v4l2_stereo_open_on(const struct iso_v4l2_system *system,
                                   const struct iso_option *options, size_t n_options,
                                   const struct iso_clock *clock, void **self,
                                   struct iso_fault *fault)
{
    struct iso_picture_stream_options stream = {.owner = owner,
                                                .clock = clock,
                                                .monotonic_ns = system->monotonic_ns,
                                                .context = system->context,
                                                .n_cameras = ISO_EYES};
    struct iso_v4l2_wish wishes[ISO_EYES] = {{0}};
    struct pair *pair = calloc(1, sizeof *pair);
    if (!pair) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    int error = read_options(options, n_options, wishes, &stream.tolerance_ns, fault);
    if (!error) {
        error = iso_sensor_stereo_init(owner, options, n_options, &pair->stereo, fault);
    }
    stream.width_px = pair->stereo.width_px;
    stream.height_px = pair->stereo.height_px;
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        wishes[eye].width_px = pair->stereo.width_px;
        wishes[eye].height_px = pair->stereo.height_px;
        error = iso_v4l2_node_open(system, &wishes[eye], &pair->nodes[eye], fault);
        if (!error) {
            stream.sources[eye] = iso_v4l2_node_source(pair->nodes[eye]);
        }
    }
    if (!error) {
        error = iso_picture_stream_open(&stream, &pair->stream, fault);
    }
    if (error) {
        pair_close(pair);
        return error;
    }
    *self = pair;
    return 0;
}

static int pair_open(const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    return iso_sensor_v4l2_stereo_open_on(&iso_v4l2_kernel, options, n_options, clock, self, fault);
}

static int pair_start(void *self, struct iso_fault *fault)
{
    struct pair *pair = self;
    return iso_picture_stream_start(pair->stream, fault);
}

static int pair_stop(void *self)
{
    struct pair *pair = self;
    return iso_picture_stream_stop(pair->stream);
}

static int pair_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                     struct iso_fault *fault)
{
    struct pair *pair = self;
    return iso_sensor_stereo_wait(&pair->stereo, pair->stream, owner, deadline_ns, frame, fault);
}

static int pair_poll_fd(void *self)
{
    struct pair *pair = self;
    return iso_picture_stream_fd(pair->stream);
}

static int pair_describe(void *self, struct iso_sensor_description *out)
{
    const struct pair *pair = self;
    iso_sensor_stereo_describe(&pair->stereo, iso_v4l2_node_bus(pair->nodes[ISO_EYE_LEFT]), out);
    return 0;
}

static void pair_health(void *self, struct iso_sensor_device_health *out)
{
    const struct pair *pair = self;
    out->dropped = iso_picture_stream_dropped(pair->stream);
}

const struct iso_sensor_ops iso_sensor_v4l2_stereo_ops = {
    .name = "v4l2-stereo",
    .open = pair_open,
    .start = pair_start,
    .wait = pair_wait,
    .poll_fd = pair_poll_fd,
    .describe = pair_describe,
    .health = pair_health,
    .stop = pair_stop,
    .close = pair_close,
};
