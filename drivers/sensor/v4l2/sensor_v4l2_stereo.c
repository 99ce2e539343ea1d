#include "drivers/sensor/v4l2/sensor_v4l2_stereo.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sensor/picture/picture_format.h"
#include "drivers/sensor/picture/sensor_stereo.h"
#include "drivers/sensor/v4l2/sensor_v4l2_node.h"

static const char owner[] = "sensor v4l2-stereo";

struct pair {
    struct iso_sensor_stereo stereo;
    struct iso_v4l2_node *nodes[ISO_EYES];
};

static void pair_close(void *self)
{
    struct pair *pair = self;
    iso_sensor_stereo_done(&pair->stereo);
    iso_v4l2_node_close(pair->nodes[ISO_EYE_LEFT]);
    iso_v4l2_node_close(pair->nodes[ISO_EYE_RIGHT]);
    free(pair);
}

static int open_nodes(const struct iso_v4l2_system *system,
                      const struct iso_sensor_stereo_cameras *cameras, struct pair *pair,
                      struct iso_picture_stream_options *stream, struct iso_fault *fault)
{
    int error = 0;
    struct iso_v4l2_wish wish = {.owner = owner,
                                 .width_px = pair->stereo.width_px,
                                 .height_px = pair->stereo.height_px,
                                 .fps = cameras->fps};
    memcpy(wish.formats, iso_picture_grey_formats, sizeof iso_picture_grey_formats);
    stream->width_px = wish.width_px;
    stream->height_px = wish.height_px;
    stream->tolerance_ns = cameras->tolerance_ns;
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        wish.path = cameras->ids[eye];
        error = iso_v4l2_node_open(system, &wish, &pair->nodes[eye], fault);
        if (!error) {
            stream->sources[eye] = iso_v4l2_node_source(pair->nodes[eye]);
        }
    }
    return error;
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
    struct iso_sensor_stereo_cameras cameras;
    struct pair *pair = calloc(1, sizeof *pair);
    if (!pair) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    int error = iso_sensor_stereo_init(owner, options, n_options, &pair->stereo, &cameras, fault);
    if (!error) {
        error = open_nodes(system, &cameras, pair, &stream, fault);
    }
    if (!error) {
        error = iso_picture_stream_open(&stream, &pair->stereo.base.stream, fault);
    }
    if (error) {
        pair_close(pair);
        return error;
    }
    *self = pair;
    return 0;
}

static int pair_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    return iso_sensor_stereo_check(owner, options, n_options, fault);
}

static int pair_open(const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    return iso_sensor_v4l2_stereo_open_on(&iso_v4l2_kernel, options, n_options, clock, self, fault);
}

static int pair_load(struct iso_fault *fault)
{
    return iso_sensor_stereo_load(owner, fault);
}

static int pair_describe(void *self, struct iso_sensor_description *out)
{
    const struct pair *pair = self;
    iso_sensor_stereo_describe(&pair->stereo, iso_v4l2_node_bus(pair->nodes[ISO_EYE_LEFT]), out);
    return 0;
}

const struct iso_sensor_ops iso_sensor_v4l2_stereo_ops = {
    .name = "v4l2-stereo",
    .options = iso_sensor_stereo_options,
    .probe = iso_v4l2_probe_kernel,
    .probes_at_once = true,
    .load = pair_load,
    .check = pair_check,
    .open = pair_open,
    .start = iso_picture_sensor_start,
    .wait = iso_sensor_stereo_wait,
    .poll_fd = iso_picture_sensor_poll_fd,
    .set_interval = iso_picture_sensor_set_interval,
    .describe = pair_describe,
    .health = iso_picture_sensor_health,
    .stop = iso_picture_sensor_stop,
    .close = pair_close,
};
