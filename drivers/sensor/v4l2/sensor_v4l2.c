#include "drivers/sensor/v4l2/sensor_v4l2.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sensor/contract/camera_file.h"
#include "drivers/sensor/picture/picture_format.h"
#include "drivers/sensor/picture/picture_sensor.h"
#include "drivers/sensor/v4l2/sensor_v4l2_node.h"

static const char owner[] = "sensor v4l2";

struct v4l2 {
    struct iso_picture_sensor base;
    struct iso_camera_file camera;
    struct iso_v4l2_node *nodes[2]; /* depth, and infrared (or NULL) */
    struct iso_frame *frame;
    bool has_ir;
};

/* ---- opening and closing ---------------------------------------------------- */

static const struct iso_option_spec option_specs[] = {
    {.name = "device",
     .required = true,
     .help = "the node that gives depths, such as /dev/video0 or a link in /dev/v4l/by-path"},
    {.name = "camera",
     .kind = ISO_OPTION_PATH,
     .required = true,
     .help = "a file like recording.ini that describes the depth camera"},
    {.name = "ir_device",
     .standard = "",
     .help = "the node that gives the infrared picture; no infrared if empty"},
    ISO_PICTURE_SENSOR_OPTIONS,
    {.name = NULL},
};

/* Reads the options of both nodes, and how close in time their pictures must be. */
static int read_options(const struct iso_option *options, size_t n_options, struct v4l2 *v4l2,
                        struct iso_v4l2_wish wishes[2], struct iso_picture_stream_options *out,
                        struct iso_fault *fault)
{
    const struct iso_option_set set = {option_specs, options, n_options};
    const char *ir = iso_option_text(&set, "ir_device");
    int fps = 0;
    const int error = iso_camera_file_read(iso_option_text(&set, "camera"), &v4l2->camera, fault);
    if (error) {
        return error;
    }
    iso_picture_sensor_options(&set, &fps, &out->tolerance_ns);
    v4l2->has_ir = *ir;
    out->n_cameras = v4l2->has_ir ? 2 : 1;
    out->width_px = v4l2->camera.meta.camera.width_px;
    out->height_px = v4l2->camera.meta.camera.height_px;
    wishes[0] = (struct iso_v4l2_wish){.owner = owner,
                                       .path = iso_option_text(&set, "device"),
                                       .width_px = v4l2->camera.meta.camera.width_px,
                                       .height_px = v4l2->camera.meta.camera.height_px,
                                       .fps = fps,
                                       .formats = {V4L2_PIX_FMT_Z16}};
    wishes[1] = wishes[0];
    wishes[1].path = ir;
    memcpy(wishes[1].formats, iso_picture_grey_formats, sizeof iso_picture_grey_formats);
    return 0;
}

static void v4l2_close(void *self)
{
    struct v4l2 *v4l2 = self;
    iso_picture_stream_close(v4l2->base.stream);
    iso_v4l2_node_close(v4l2->nodes[0]);
    iso_v4l2_node_close(v4l2->nodes[1]);
    iso_frame_free(v4l2->frame);
    free(v4l2);
}

int iso_sensor_v4l2_open_on(const struct iso_v4l2_system *system, const struct iso_option *options,
                            size_t n_options, const struct iso_clock *clock, void **self,
                            struct iso_fault *fault)
{
    struct iso_picture_stream_options stream = {.owner = owner,
                                                .clock = clock,
                                                .monotonic_ns = system->monotonic_ns,
                                                .context = system->context};
    struct iso_v4l2_wish wishes[2];
    struct v4l2 *v4l2 = calloc(1, sizeof *v4l2);
    if (!v4l2) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    int error = read_options(options, n_options, v4l2, wishes, &stream, fault);
    for (int i = 0; !error && i < stream.n_cameras; i++) {
        error = iso_v4l2_node_open(system, &wishes[i], &v4l2->nodes[i], fault);
        if (!error) {
            stream.sources[i] = iso_v4l2_node_source(v4l2->nodes[i]);
        }
    }
    if (!error) {
        error = iso_picture_stream_open(&stream, &v4l2->base.stream, fault);
    }
    const struct iso_camera *camera = &v4l2->camera.meta.camera;
    if (!error &&
        iso_frame_new(camera, camera->width_px, camera->height_px, v4l2->has_ir, &v4l2->frame)) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    if (error) {
        v4l2_close(v4l2);
        return error;
    }
    *self = v4l2;
    return 0;
}

static int v4l2_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    struct iso_picture_stream_options stream;
    struct iso_v4l2_wish wishes[2];
    struct v4l2 v4l2 = {.has_ir = false};
    return read_options(options, n_options, &v4l2, wishes, &stream, fault);
}

static int v4l2_open(const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    return iso_sensor_v4l2_open_on(&iso_v4l2_kernel, options, n_options, clock, self, fault);
}

/* ---- streaming -------------------------------------------------------------- */

static int v4l2_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                     struct iso_fault *fault)
{
    struct v4l2 *v4l2 = self;
    struct iso_picture_set set;
    const int error = iso_picture_stream_wait(v4l2->base.stream, deadline_ns, &set, fault);
    if (error) {
        return error;
    }
    iso_picture_to_depth(&set.pictures[0], v4l2->camera.meta.unit_mm, v4l2->frame->depth_mm);
    if (v4l2->has_ir) {
        iso_picture_to_intensity(&set.pictures[1], v4l2->frame->intensity);
    }
    v4l2->frame->t_ns = set.t_ns;
    v4l2->frame->sequence = set.sequence;
    *frame = v4l2->frame;
    return 0;
}

static int v4l2_describe(void *self, struct iso_sensor_description *out)
{
    const struct v4l2 *v4l2 = self;
    *out = (struct iso_sensor_description){.width_px = v4l2->camera.meta.camera.width_px,
                                           .height_px = v4l2->camera.meta.camera.height_px,
                                           .intensity = v4l2->has_ir,
                                           .unit_mm = v4l2->camera.meta.unit_mm};
    (void)snprintf(out->model, sizeof out->model, "%s", v4l2->camera.meta.sensor);
    char camera[64];
    iso_camera_file_describe(&v4l2->camera, camera, sizeof camera);
    out->calibration_code = v4l2->camera.meta.nominal ? ISO_FAULT_CALIBRATION_NOMINAL
                                                      : ISO_FAULT_NONE;
    (void)snprintf(out->calibration, sizeof out->calibration, "%s, %g mm a count", camera,
                   v4l2->camera.meta.unit_mm);
    (void)snprintf(out->serial, sizeof out->serial, "%s", iso_v4l2_node_bus(v4l2->nodes[0]));
    return 0;
}

const struct iso_sensor_ops iso_sensor_v4l2_ops = {
    .name = "v4l2",
    .options = option_specs,
    .probe = iso_v4l2_probe_kernel,
    .probes_at_once = true,
    .check = v4l2_check,
    .open = v4l2_open,
    .start = iso_picture_sensor_start,
    .wait = v4l2_wait,
    .poll_fd = iso_picture_sensor_poll_fd,
    .set_interval = iso_picture_sensor_set_interval,
    .describe = v4l2_describe,
    .health = iso_picture_sensor_health,
    .stop = iso_picture_sensor_stop,
    .close = v4l2_close,
};
