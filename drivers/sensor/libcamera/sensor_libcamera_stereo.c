#include "drivers/sensor/libcamera/sensor_libcamera_stereo.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/sensor/libcamera/libcamera_module.h"
#include "drivers/sensor/picture/sensor_stereo.h"

static const char owner[] = "sensor libcamera-stereo";
static const char *const eye_names[ISO_EYES] = {"left", "right"};

struct eye {
    struct iso_libcamera_pair *cameras;
    int index;
};

struct pair {
    struct iso_sensor_stereo stereo;
    struct iso_libcamera_pair *cameras;
    struct eye eyes[ISO_EYES];
    char serial[64];
};

/* ---- a camera as a source --------------------------------------------------- */

/* Reports an error of a camera. 0 and -EAGAIN are not faults. */
static int complain_of_eye(const struct eye *eye, int error, struct iso_fault *fault)
{
    enum iso_fault_code code = ISO_FAULT_SENSOR_FAILED;
    const char *what = "the stream broke";
    if (error == 0 || error == -EAGAIN) {
        return error;
    }
    if (error == -ENODEV) {
        code = ISO_FAULT_SENSOR_GONE;
        what = "the camera is gone";
    } else if (error == -EBADMSG) {
        what = "a picture came damaged";
    }
    return iso_fault_set_code(fault, code, error, "%s: %s: %s", owner, eye_names[eye->index], what);
}

static int eye_start(void *self, struct iso_fault *fault)
{
    const struct eye *eye = self;
    return complain_of_eye(eye, iso_libcamera_start(eye->cameras, eye->index), fault);
}

static int eye_stop(void *self)
{
    const struct eye *eye = self;
    return iso_libcamera_stop(eye->cameras, eye->index);
}

/* The V4L2 code of a DRM pixel format, and its bytes per pixel; 0 for other formats. */
static uint32_t format_of(uint32_t fourcc, size_t *bytes)
{
    static const struct {
        char drm[5];
        uint32_t v4l2;
        size_t bytes;
    } formats[] = {
        {"R8  ", V4L2_PIX_FMT_GREY, 1},
        {"R12 ", V4L2_PIX_FMT_Y12, 2},
        {"R10 ", V4L2_PIX_FMT_Y10, 2},
        {"YUYV", V4L2_PIX_FMT_YUYV, 2},
    };
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const unsigned char *c = (const unsigned char *)formats[i].drm;
        if (fourcc == v4l2_fourcc(c[0], c[1], c[2], c[3])) {
            *bytes = formats[i].bytes;
            return formats[i].v4l2;
        }
    }
    return 0;
}

static int eye_give_back(void *self, struct iso_fault *fault)
{
    const struct eye *eye = self;
    return complain_of_eye(eye, iso_libcamera_give_back(eye->cameras, eye->index), fault);
}

static int eye_take(void *self, struct iso_picture *out, struct iso_fault *fault)
{
    const struct eye *eye = self;
    struct iso_libcamera_picture picture;
    size_t bytes = 0;
    int error = iso_libcamera_take(eye->cameras, eye->index, &picture);
    if (error) {
        return complain_of_eye(eye, error, fault);
    }
    const uint32_t format = format_of(picture.fourcc, &bytes);
    const size_t row = bytes * (size_t)picture.width_px;
    if (!format || picture.stride_bytes < row ||
        picture.size_bytes < picture.stride_bytes * ((size_t)picture.height_px - 1) + row) {
        error = eye_give_back(self, fault);
        return error ? error : complain_of_eye(eye, -EBADMSG, fault);
    }
    *out = (struct iso_picture){.bytes = picture.bytes,
                                .stride_bytes = picture.stride_bytes,
                                .row_bytes = row,
                                .format = format,
                                .width_px = picture.width_px,
                                .height_px = picture.height_px,
                                .sequence = picture.sequence,
                                .stamp_ns = picture.stamp_ns};
    return 0;
}

static int eye_fd(void *self)
{
    const struct eye *eye = self;
    return iso_libcamera_fd(eye->cameras, eye->index);
}

/* ---- opening and closing ---------------------------------------------------- */

static int load_libcamera(struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    const int error = iso_libcamera_module_load(&why);
    return error ? iso_fault_set_code(fault, why.code, error, "%s: %s", owner, why.text) : 0;
}

static int pair_load(struct iso_fault *fault)
{
    const int error = iso_sensor_stereo_load(owner, fault);
    return error ? error : load_libcamera(fault);
}

/* libcamera stamps pictures with this clock. */
static int64_t monotonic_ns(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static void pair_close(void *self)
{
    struct pair *pair = self;
    iso_sensor_stereo_done(&pair->stereo);
    iso_libcamera_pair_close(pair->cameras);
    free(pair);
}

static enum iso_fault_code code_of(int error)
{
    switch (error) {
    case -ENODEV:
        return ISO_FAULT_SENSOR_MISSING;
    case -EBUSY:
        return ISO_FAULT_SENSOR_BUSY;
    case -EINVAL:
        return ISO_FAULT_SENSOR_FORMAT;
    case -ENOMEM:
        return ISO_FAULT_OUT_OF_MEMORY;
    default:
        return ISO_FAULT_SENSOR_FAILED;
    }
}

static int open_cameras(struct pair *pair, const struct iso_sensor_stereo_cameras *cameras,
                        struct iso_picture_stream_options *stream, struct iso_fault *fault)
{
    char text[ISO_LIBCAMERA_TEXT];
    const struct iso_libcamera_options options = {
        .ids = {cameras->ids[ISO_EYE_LEFT], cameras->ids[ISO_EYE_RIGHT]},
        .width_px = pair->stereo.width_px,
        .height_px = pair->stereo.height_px,
        .fps = cameras->fps};
    stream->width_px = options.width_px;
    stream->height_px = options.height_px;
    stream->tolerance_ns = cameras->tolerance_ns;
    const int error = iso_libcamera_pair_open(&options, &pair->cameras, text);
    if (error) {
        return iso_fault_set_code(fault, code_of(error), error, "%s: libcamera: %s", owner, text);
    }
    for (int i = 0; i < ISO_EYES; i++) {
        pair->eyes[i] = (struct eye){pair->cameras, i};
        stream->sources[i] = (struct iso_picture_source){.self = &pair->eyes[i],
                                                         .start = eye_start,
                                                         .stop = eye_stop,
                                                         .take = eye_take,
                                                         .give_back = eye_give_back,
                                                         .fd = eye_fd};
    }
    return iso_picture_stream_open(stream, &pair->stereo.base.stream, fault);
}

static int pair_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    return iso_sensor_stereo_check(owner, options, n_options, fault);
}

static int pair_open(const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    struct iso_sensor_stereo_cameras cameras;
    struct iso_picture_stream_options stream = {
        .owner = owner, .clock = clock, .monotonic_ns = monotonic_ns, .n_cameras = ISO_EYES};
    struct pair *pair = calloc(1, sizeof *pair);
    if (!pair) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    int error = iso_sensor_stereo_init(owner, options, n_options, &pair->stereo, &cameras, fault);
    if (!error) {
        error = load_libcamera(fault);
    }
    if (!error) {
        (void)snprintf(pair->serial, sizeof pair->serial, "%s", cameras.ids[ISO_EYE_LEFT]);
        error = open_cameras(pair, &cameras, &stream, fault);
    }
    if (error) {
        pair_close(pair);
        return error;
    }
    *self = pair;
    return 0;
}

/* ---- available cameras ------------------------------------------------------ */

struct visit {
    iso_sensor_visitor *visit;
    void *context;
};

static void visit_camera(const char *id, const char *model, void *context)
{
    const struct visit *visit = context;
    struct iso_sensor_device device = {.depth = false};
    (void)snprintf(device.id, sizeof device.id, "%s", id);
    (void)snprintf(device.label, sizeof device.label, "%s", model);
    visit->visit(&device, visit->context);
}

static int pair_probe(iso_sensor_visitor *visit, void *context, struct iso_fault *fault)
{
    struct visit told = {visit, context};
    const int error = load_libcamera(fault);
    if (error) {
        return error;
    }
    return iso_libcamera_list(visit_camera, &told)
               ? iso_fault_set(fault, -EIO, "%s: the cameras cannot be listed", owner)
               : 0;
}

static int pair_describe(void *self, struct iso_sensor_description *out)
{
    const struct pair *pair = self;
    iso_sensor_stereo_describe(&pair->stereo, pair->serial, out);
    return 0;
}

const struct iso_sensor_ops iso_sensor_libcamera_stereo_ops = {
    .name = "libcamera-stereo",
    .options = iso_sensor_stereo_options,
    .probe = pair_probe,
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
