#include "drivers/sensor/v4l2/sensor_v4l2_node.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BUFFERS = 4, BUFFERS_MIN = 2 };

struct buffer {
    void *at;
    size_t length;
};

struct iso_v4l2_node {
    const struct iso_v4l2_system *system;
    const char *owner;
    char path[128], card[33], bus[33];
    int fd;
    struct v4l2_pix_format format;
    struct buffer buffers[BUFFERS];
    unsigned n_buffers;
    bool streaming;
    struct v4l2_buffer taken;
};

static int call_node(const struct iso_v4l2_node *node, unsigned long request, void *argument)
{
    return node->system->ioctl(node->system->context, node->fd, request, argument);
}

enum iso_fault_code iso_v4l2_fault_code(int error)
{
    switch (error) {
    case -ENODEV:
    case -ENXIO:
    case -ENOENT:
        return ISO_FAULT_SENSOR_MISSING;
    case -EACCES:
    case -EPERM:
        return ISO_FAULT_SENSOR_DENIED;
    case -EBUSY:
        return ISO_FAULT_SENSOR_BUSY;
    case -ENOSPC: /* a USB bus lacks bandwidth */
        return ISO_FAULT_USB_FULL;
    case -ENOMEM:
        return ISO_FAULT_OUT_OF_MEMORY;
    default:
        return ISO_FAULT_SENSOR_FAILED;
    }
}

/* Converts an errno to one that the sensor class allows. Others become -EIO. */
static int class_error(int error)
{
    switch (error) {
    case -ENXIO:
    case -ENOENT:
        return -ENODEV;
    case -ENODEV:
    case -EBUSY:
    case -EACCES:
    case -ENOMEM:
    case -EINVAL:
        return error;
    default:
        return -EIO;
    }
}

static int complain_of_node(const struct iso_v4l2_node *node, int error, const char *what,
                            struct iso_fault *fault)
{
    return iso_fault_set_code(fault, iso_v4l2_fault_code(error), class_error(error),
                              "%s: %s: %s: %s", node->owner, node->path, what, strerror(-error));
}

static int node_stop(void *self);
static int node_give_back(void *self, struct iso_fault *fault);

/* ---- opening ---------------------------------------------------------------- */

static int identify_node(struct iso_v4l2_node *node, struct iso_fault *fault)
{
    struct v4l2_capability capability = {0};
    const int error = call_node(node, VIDIOC_QUERYCAP, &capability);
    if (error == -ENOTTY || error == -EINVAL) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_UNFIT, -ENODEV,
                                  "%s: %s: is not a video device", node->owner, node->path);
    }
    if (error) {
        return complain_of_node(node, error, "its capabilities cannot be read", fault);
    }
    const uint32_t can = capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps
                                                                        : capability.capabilities;
    if (!(can & V4L2_CAP_VIDEO_CAPTURE) || !(can & V4L2_CAP_STREAMING)) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_UNFIT, -ENODEV,
                                  "%s: %s: is not a camera that streams", node->owner, node->path);
    }
    (void)snprintf(node->card, sizeof node->card, "%.32s", (const char *)capability.card);
    (void)snprintf(node->bus, sizeof node->bus, "%.32s", (const char *)capability.bus_info);
    return 0;
}

static bool offers_format(const struct iso_v4l2_node *node, uint32_t format)
{
    for (uint32_t i = 0; i < 256; i++) {
        struct v4l2_fmtdesc description = {.index = i, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
        if (call_node(node, VIDIOC_ENUM_FMT, &description)) {
            return false;
        }
        if (description.pixelformat == format) {
            return true;
        }
    }
    return false;
}

/* The bytes of a row of pixels; 0 for a format that is not supported. */
static size_t row_bytes(uint32_t format, int width_px)
{
    switch (format) {
    case V4L2_PIX_FMT_GREY:
        return (size_t)width_px;
    case V4L2_PIX_FMT_Z16:
    case V4L2_PIX_FMT_Y10:
    case V4L2_PIX_FMT_Y12:
    case V4L2_PIX_FMT_Y16:
    case V4L2_PIX_FMT_YUYV:
    case V4L2_PIX_FMT_UYVY:
        return 2 * (size_t)width_px;
    default:
        return 0;
    }
}

static int choose_format(struct iso_v4l2_node *node, const struct iso_v4l2_wish *wish,
                         struct iso_fault *fault)
{
    const uint32_t *wanted = wish->formats;
    while (*wanted && !offers_format(node, *wanted)) {
        wanted++;
    }
    if (!*wanted) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EINVAL,
                                  "%s: %s (%s): has none of the required pixel formats",
                                  node->owner, node->path, node->card);
    }
    struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    format.fmt.pix.width = (uint32_t)wish->width_px;
    format.fmt.pix.height = (uint32_t)wish->height_px;
    format.fmt.pix.pixelformat = *wanted;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    const int error = call_node(node, VIDIOC_S_FMT, &format);
    if (error) {
        return complain_of_node(node, error, "its format cannot be set", fault);
    }
    const struct v4l2_pix_format *got = &format.fmt.pix;
    if (got->pixelformat != *wanted || got->width != (uint32_t)wish->width_px ||
        got->height != (uint32_t)wish->height_px) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EINVAL,
                                  "%s: %s (%s): delivers %u x %u, not %d x %d", node->owner,
                                  node->path, node->card, got->width, got->height, wish->width_px,
                                  wish->height_px);
    }
    node->format = *got;
    if (node->format.bytesperline < row_bytes(*wanted, wish->width_px)) {
        node->format.bytesperline = (uint32_t)row_bytes(*wanted, wish->width_px);
    }
    return 0;
}

/* A camera whose rate cannot be set keeps its own rate. */
static void choose_rate(struct iso_v4l2_node *node, int fps)
{
    struct v4l2_streamparm parameters = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    parameters.parm.capture.timeperframe.numerator = 1;
    parameters.parm.capture.timeperframe.denominator = (uint32_t)fps;
    if (fps > 0) {
        (void)call_node(node, VIDIOC_S_PARM, &parameters);
    }
}

int iso_v4l2_node_open(const struct iso_v4l2_system *system, const struct iso_v4l2_wish *wish,
                       struct iso_v4l2_node **out, struct iso_fault *fault)
{
    struct iso_v4l2_node *node = calloc(1, sizeof *node);
    if (!node) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", wish->owner);
    }
    node->system = system;
    node->owner = wish->owner;
    (void)snprintf(node->path, sizeof node->path, "%s", wish->path);
    node->fd = system->open(system->context, wish->path);
    int error = node->fd < 0 ? complain_of_node(node, node->fd, "cannot be opened", fault) : 0;
    if (!error) {
        error = identify_node(node, fault);
    }
    if (!error) {
        error = choose_format(node, wish, fault);
    }
    if (error) {
        iso_v4l2_node_close(node);
        return error;
    }
    choose_rate(node, wish->fps);
    *out = node;
    return 0;
}

void iso_v4l2_node_close(struct iso_v4l2_node *node)
{
    if (!node) {
        return;
    }
    (void)node_stop(node);
    if (node->fd >= 0) {
        node->system->close(node->system->context, node->fd);
    }
    free(node);
}

/* ---- streaming -------------------------------------------------------------- */

static struct v4l2_buffer buffer_number(unsigned index)
{
    return (struct v4l2_buffer){
        .index = index, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
}

static int request_buffers(struct iso_v4l2_node *node, unsigned count, unsigned *got)
{
    struct v4l2_requestbuffers wanted = {
        .count = count, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
    const int error = call_node(node, VIDIOC_REQBUFS, &wanted);
    *got = wanted.count;
    return error;
}

static int add_buffer(struct iso_v4l2_node *node, unsigned index)
{
    struct v4l2_buffer buffer = buffer_number(index);
    const int error = call_node(node, VIDIOC_QUERYBUF, &buffer);
    if (error) {
        return error;
    }
    void *at = node->system->map(node->system->context, node->fd, buffer.length,
                                 (int64_t)buffer.m.offset);
    if (!at) {
        return -ENOMEM;
    }
    node->buffers[node->n_buffers++] = (struct buffer){at, buffer.length};
    return call_node(node, VIDIOC_QBUF, &buffer);
}

/* The kernel may report that a device was unplugged only when the device is queried. */
static bool is_gone(const struct iso_v4l2_node *node)
{
    struct v4l2_capability capability;
    return call_node(node, VIDIOC_QUERYCAP, &capability) == -ENODEV;
}

static int node_start(void *self, struct iso_fault *fault)
{
    struct iso_v4l2_node *node = self;
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    unsigned count = 0;
    int error = request_buffers(node, BUFFERS, &count);
    if (!error && count < BUFFERS_MIN) {
        error = -ENOMEM;
    }
    for (unsigned i = 0; !error && i < count && i < BUFFERS; i++) {
        error = add_buffer(node, i);
    }
    if (!error) {
        error = call_node(node, VIDIOC_STREAMON, &type);
        node->streaming = !error;
    }
    if (error) {
        (void)node_stop(node);
        if (is_gone(node)) {
            (void)complain_of_node(node, -ENODEV, "does not stream", fault);
            return iso_fault_recode(fault, ISO_FAULT_SENSOR_GONE, -ENODEV);
        }
        return complain_of_node(node, error == -EINVAL ? -EIO : error, "does not stream", fault);
    }
    return 0;
}

static int node_stop(void *self)
{
    struct iso_v4l2_node *node = self;
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE, error = 0;
    unsigned none;
    if (node->streaming) {
        error = call_node(node, VIDIOC_STREAMOFF, &type);
        node->streaming = false;
    }
    const bool had = node->n_buffers > 0;
    while (node->n_buffers > 0) {
        const struct buffer *buffer = &node->buffers[--node->n_buffers];
        node->system->unmap(node->system->context, buffer->at, buffer->length);
    }
    if (had) {
        (void)request_buffers(node, 0, &none); /* another process may use the camera then */
    }
    return error && error != -ENODEV ? -EIO : error;
}

static int explain_stream(struct iso_v4l2_node *node, int error, struct iso_fault *fault)
{
    error = error == -ENODEV || is_gone(node) ? -ENODEV : -EIO;
    return iso_fault_set_code(fault,
                              error == -ENODEV ? ISO_FAULT_SENSOR_GONE : ISO_FAULT_SENSOR_FAILED,
                              error, "%s: %s: %s", node->owner, node->path,
                              error == -ENODEV ? "the device is gone" : "the stream broke");
}

/* The time at which the picture was taken by the camera, or, if the driver uses another clock, the
 * present time. */
static int64_t stamp_of(const struct iso_v4l2_node *node, const struct v4l2_buffer *buffer)
{
    if ((buffer->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
        return buffer->timestamp.tv_sec * INT64_C(1000000000) +
               buffer->timestamp.tv_usec * INT64_C(1000);
    }
    return node->system->monotonic_ns(node->system->context);
}

static int node_take(void *self, struct iso_picture *out, struct iso_fault *fault)
{
    struct iso_v4l2_node *node = self;
    const struct v4l2_pix_format *format = &node->format;
    struct v4l2_buffer buffer = buffer_number(0);
    int error = call_node(node, VIDIOC_DQBUF, &buffer);
    if (error == -EAGAIN) {
        return error;
    }
    if (error || buffer.index >= node->n_buffers) {
        return explain_stream(node, error ? error : -EIO, fault);
    }
    node->taken = buffer;
    const size_t row = row_bytes(format->pixelformat, (int)format->width);
    const size_t needed = (size_t)format->bytesperline * (format->height - 1) + row;
    const struct buffer *mapped = &node->buffers[buffer.index];
    const size_t used = buffer.bytesused < mapped->length ? buffer.bytesused : mapped->length;
    if (buffer.flags & V4L2_BUF_FLAG_ERROR || used < needed) {
        error = node_give_back(node, fault);
        return error ? error
                     : iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, -EBADMSG,
                                          "%s: %s: picture %u came damaged (%zu of %zu "
                                          "bytes)",
                                          node->owner, node->path, buffer.sequence, used, needed);
    }
    *out = (struct iso_picture){.bytes = mapped->at,
                                .stride_bytes = format->bytesperline,
                                .row_bytes = row,
                                .format = format->pixelformat,
                                .width_px = (int)format->width,
                                .height_px = (int)format->height,
                                .sequence = buffer.sequence,
                                .stamp_ns = stamp_of(node, &buffer)};
    return 0;
}

static int node_give_back(void *self, struct iso_fault *fault)
{
    struct iso_v4l2_node *node = self;
    struct v4l2_buffer buffer = buffer_number(node->taken.index);
    const int error = call_node(node, VIDIOC_QBUF, &buffer);
    return error ? explain_stream(node, error, fault) : 0;
}

static int node_fd(void *self)
{
    const struct iso_v4l2_node *node = self;
    return node->fd;
}

struct iso_picture_source iso_v4l2_node_source(struct iso_v4l2_node *node)
{
    return (struct iso_picture_source){.self = node,
                                       .start = node_start,
                                       .stop = node_stop,
                                       .take = node_take,
                                       .give_back = node_give_back,
                                       .fd = node_fd};
}

const char *iso_v4l2_node_bus(const struct iso_v4l2_node *node)
{
    return node->bus;
}
