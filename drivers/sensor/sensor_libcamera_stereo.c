#include "drivers/sensor/sensor_libcamera_stereo.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/sensor/libcamera_pair.h"
#include "drivers/sensor/picture_format.h"
#include "drivers/sensor/picture_stream.h"
#include "drivers/sensor/sensor_stereo.h"

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
    struct iso_picture_stream *stream;
    char serial[64];
};

/* ---- a camera as a source --------------------------------------------------- */

static int complain(const struct eye *eye, int error, struct iso_fault *fault)
{
    const char *what = error == -ENODEV    ? "the camera is gone"
                       : error == -EBADMSG ? "a picture came damaged"
                                           : "the stream broke";
    return error == 0 || error == -EAGAIN
               ? error
               : iso_fault_set(fault, error, "%s: %s: %s", owner, eye_names[eye->index], what);
}

static int eye_start(void *self, struct iso_fault *fault)
{
    const struct eye *eye = self;
    return complain(eye, iso_libcamera_start(eye->cameras, eye->index), fault);
}

static int eye_stop(void *self)
{
    const struct eye *eye = self;
    return iso_libcamera_stop(eye->cameras, eye->index);
}

/* What V4L2 calls a pixel format of DRM's, and its bytes a pixel; 0 for others. */
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
    return complain(eye, iso_libcamera_give_back(eye->cameras, eye->index), fault);
}

static int eye_take(void *self, struct iso_picture *out, struct iso_fault *fault)
{
    const struct eye *eye = self;
    struct iso_libcamera_picture picture;
    size_t bytes = 0;
    int error = iso_libcamera_take(eye->cameras, eye->index, &picture);
    if (error) {
        return complain(eye, error, fault);
    }
    uint32_t format = format_of(picture.fourcc, &bytes);
    size_t row = bytes * (size_t)picture.width_px;
    if (!format || picture.stride_bytes < row ||
        picture.size_bytes < picture.stride_bytes * ((size_t)picture.height_px - 1) + row) {
        error = eye_give_back(self, fault);
        return error ? error : complain(eye, -EBADMSG, fault);
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

/* libcamera stamps pictures by this clock. */
static int64_t monotonic_ns(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static int read_options(const struct iso_option *options, size_t n_options,
                        struct iso_libcamera_options *out, int64_t *tolerance_ns,
                        struct iso_fault *fault)
{
    static const char *const known[] = {"left",    "right",  "calibration", "fps", "pair_ms",
                                        "near_mm", "far_mm", "confidence",  NULL};
    double fps = 0.0, pair_ms = 0.0;
    int error = iso_options_check(owner, options, n_options, known, fault);
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        error = iso_options_required(owner, options, n_options, eye_names[eye], &out->ids[eye],
                                     fault);
    }
    error = error ? error
                  : iso_options_number(owner, options, n_options, "fps", 1.0, 1000.0, 0.0, &fps,
                                       fault);
    error = error ? error
                  : iso_options_number(owner, options, n_options, "pair_ms", 0.1, 1000.0, 4.0,
                                       &pair_ms, fault);
    out->fps = (int)fps;
    *tolerance_ns = (int64_t)(pair_ms * 1e6);
    return error;
}

static void pair_close(void *self)
{
    struct pair *pair = self;
    iso_picture_stream_close(pair->stream);
    iso_libcamera_pair_close(pair->cameras);
    iso_sensor_stereo_done(&pair->stereo);
    free(pair);
}

static int open_cameras(struct pair *pair, struct iso_libcamera_options *cameras,
                        struct iso_picture_stream_options *stream, struct iso_fault *fault)
{
    char text[ISO_LIBCAMERA_TEXT];
    cameras->width_px = stream->width_px = pair->stereo.width_px;
    cameras->height_px = stream->height_px = pair->stereo.height_px;
    int error = iso_libcamera_pair_open(cameras, &pair->cameras, text);
    if (error) {
        return iso_fault_set(fault, error, "%s: libcamera: %s", owner, text);
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
    return iso_picture_stream_open(stream, &pair->stream, fault);
}

static int pair_open(const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    struct iso_libcamera_options cameras = {.fps = 0};
    struct iso_picture_stream_options stream = {
        .owner = owner, .clock = clock, .monotonic_ns = monotonic_ns, .n_cameras = ISO_EYES};
    struct pair *pair = calloc(1, sizeof *pair);
    if (!pair) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    int error = read_options(options, n_options, &cameras, &stream.tolerance_ns, fault);
    if (!error) {
        error = iso_sensor_stereo_init(owner, options, n_options, &pair->stereo, fault);
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

/* ---- streaming -------------------------------------------------------------- */

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
    iso_sensor_stereo_describe(&pair->stereo, pair->serial, out);
    return 0;
}

static void pair_health(void *self, struct iso_sensor_device_health *out)
{
    const struct pair *pair = self;
    out->dropped = iso_picture_stream_dropped(pair->stream);
}

const struct iso_sensor_ops iso_sensor_libcamera_stereo_ops = {
    .name = "libcamera-stereo",
    .open = pair_open,
    .start = pair_start,
    .wait = pair_wait,
    .poll_fd = pair_poll_fd,
    .describe = pair_describe,
    .health = pair_health,
    .stop = pair_stop,
    .close = pair_close,
};
