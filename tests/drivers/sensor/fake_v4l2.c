#include "tests/drivers/sensor/fake_v4l2.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cmocka.h>

static struct fake_camera *camera_of(struct fake_v4l2 *fake, int fd)
{
    for (int i = 0; i < FAKE_CAMERAS; i++) {
        if (fake->cameras[i].n_opened > 0 && fake->cameras[i].fd == fd) {
            return &fake->cameras[i];
        }
    }
    fail_msg("a call on descriptor %d, which belongs to no camera", fd);
    return NULL;
}

static uint32_t size_of(const struct fake_camera *camera)
{
    return camera->stride_bytes * camera->height_px;
}

static int fake_open(void *context, const char *path)
{
    struct fake_v4l2 *fake = context;
    for (int i = 0; i < FAKE_CAMERAS; i++) {
        struct fake_camera *camera = &fake->cameras[i];
        if (camera->path && strcmp(camera->path, path) == 0) {
            if (camera->open_error || camera->n_opened > 0) {
                return camera->open_error ? camera->open_error : -EBUSY;
            }
            camera->fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC | EFD_SEMAPHORE);
            assert_true(camera->fd >= 0);
            camera->n_opened++;
            return camera->fd;
        }
    }
    return -ENOENT;
}

static void fake_close(void *context, int fd)
{
    struct fake_camera *camera = camera_of(context, fd);
    camera->n_opened--;
    assert_int_equal(camera->n_mapped, 0);
    assert_false(camera->streaming);
    for (unsigned i = 0; i < FAKE_BUFFERS; i++) {
        free(camera->memory[i]);
        camera->memory[i] = NULL;
    }
    (void)close(fd);
}

/* ---- requests --------------------------------------------------------------- */

static int query(const struct fake_camera *camera, struct v4l2_capability *out)
{
    (void)snprintf((char *)out->card, sizeof out->card, "Fake camera");
    (void)snprintf((char *)out->bus_info, sizeof out->bus_info, "fake:%s", camera->path);
    out->capabilities = camera->capabilities | V4L2_CAP_DEVICE_CAPS;
    out->device_caps = camera->capabilities;
    return 0;
}

static int set_format(const struct fake_camera *camera, struct v4l2_format *out)
{
    assert_false(camera->streaming);
    out->fmt.pix.pixelformat = camera->format;
    out->fmt.pix.width = camera->width_px;
    out->fmt.pix.height = camera->height_px;
    out->fmt.pix.bytesperline = camera->stride_bytes;
    out->fmt.pix.sizeimage = size_of(camera);
    return 0;
}

static int request_buffers(struct fake_camera *camera, struct v4l2_requestbuffers *out)
{
    assert_false(camera->streaming);
    assert_int_equal(camera->n_mapped, 0);
    assert_int_equal(out->memory, V4L2_MEMORY_MMAP);
    out->count = out->count < FAKE_BUFFERS ? out->count : FAKE_BUFFERS;
    camera->n_buffers = out->count;
    memset(camera->queued, 0, sizeof camera->queued);
    for (unsigned i = 0; i < camera->n_buffers; i++) {
        free(camera->memory[i]);
        camera->memory[i] = calloc(1, size_of(camera));
        assert_non_null(camera->memory[i]);
    }
    return 0;
}

static int query_buffer(const struct fake_camera *camera, struct v4l2_buffer *out)
{
    assert_true(out->index < camera->n_buffers);
    out->length = size_of(camera);
    out->m.offset = out->index * 4096;
    return 0;
}

static int queue_buffer(struct fake_camera *camera, const struct v4l2_buffer *buffer)
{
    assert_true(buffer->index < camera->n_buffers);
    assert_false(camera->queued[buffer->index]);
    camera->queued[buffer->index] = true;
    return 0;
}

static int dequeue_buffer(struct fake_camera *camera, struct v4l2_buffer *out)
{
    uint64_t one;
    assert_true(camera->streaming);
    if (camera->broken) {
        return -EIO;
    }
    if (camera->n_done == 0) {
        return -EAGAIN;
    }
    assert_int_equal(read(camera->fd, &one, sizeof one), sizeof one);
    out->index = camera->done[0].index;
    out->sequence = camera->done[0].sequence;
    out->bytesused = camera->done[0].bytes;
    out->flags = camera->realtime_stamps ? V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN
                                         : V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    out->flags |= camera->done[0].damaged ? V4L2_BUF_FLAG_ERROR : 0;
    out->timestamp.tv_sec = camera->done[0].stamp_ns / 1000000000;
    out->timestamp.tv_usec = camera->done[0].stamp_ns % 1000000000 / 1000;
    camera->n_done--;
    memmove(camera->done, camera->done + 1, camera->n_done * sizeof *camera->done);
    return 0;
}

static int switch_stream(struct fake_camera *camera, bool on)
{
    uint64_t one;
    if (!on) {
        camera->streaming = false;
        camera->n_done = 0;
        while (read(camera->fd, &one, sizeof one) == (ssize_t)sizeof one) {
        }
        return 0;
    }
    assert_false(camera->streaming);
    assert_true(camera->n_buffers >= 2);
    if (!camera->start_error) {
        camera->streaming = true;
    }
    return camera->start_error;
}

static int fake_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    struct fake_camera *camera = camera_of(context, fd);
    if (camera->unplugged) {
        camera->streaming = camera->streaming && request != VIDIOC_STREAMOFF;
        return -ENODEV;
    }
    switch (request) {
    case VIDIOC_QUERYCAP:
        return query(camera, argument);
    case VIDIOC_ENUM_FMT:
        if (((struct v4l2_fmtdesc *)argument)->index > 0) {
            return -EINVAL;
        }
        ((struct v4l2_fmtdesc *)argument)->pixelformat = camera->format;
        return 0;
    case VIDIOC_S_FMT:
        return set_format(camera, argument);
    case VIDIOC_S_PARM:
        return -ENOTTY;
    case VIDIOC_REQBUFS:
        return request_buffers(camera, argument);
    case VIDIOC_QUERYBUF:
        return query_buffer(camera, argument);
    case VIDIOC_QBUF:
        return queue_buffer(camera, argument);
    case VIDIOC_DQBUF:
        return dequeue_buffer(camera, argument);
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
        return switch_stream(camera, request == VIDIOC_STREAMON);
    default:
        fail_msg("unexpected request %lx", request);
        return -ENOTTY;
    }
}

static void *fake_map(void *context, int fd, size_t length, int64_t offset)
{
    struct fake_camera *camera = camera_of(context, fd);
    assert_int_equal(length, size_of(camera));
    camera->n_mapped++;
    return camera->memory[offset / 4096];
}

static void fake_unmap(void *context, void *at, size_t length)
{
    struct fake_v4l2 *fake = context;
    for (int i = 0; i < FAKE_CAMERAS; i++) {
        struct fake_camera *camera = &fake->cameras[i];
        for (unsigned k = 0; k < FAKE_BUFFERS; k++) {
            if (camera->memory[k] == at) {
                assert_int_equal(length, size_of(camera));
                assert_true(camera->n_mapped > 0);
                camera->n_mapped--;
                return;
            }
        }
    }
    fail_msg("an address was unmapped that is no buffer");
}

static int64_t fake_monotonic_ns(void *context)
{
    return ((struct fake_v4l2 *)context)->now_ns;
}

struct iso_v4l2_system fake_v4l2_system(struct fake_v4l2 *fake)
{
    return (struct iso_v4l2_system){.context = fake,
                                    .open = fake_open,
                                    .close = fake_close,
                                    .ioctl = fake_ioctl,
                                    .map = fake_map,
                                    .unmap = fake_unmap,
                                    .monotonic_ns = fake_monotonic_ns};
}

/* ---- what the test does to a camera ----------------------------------------- */

static void wake_camera(const struct fake_camera *camera)
{
    const uint64_t one = 1;
    assert_int_equal(write(camera->fd, &one, sizeof one), sizeof one);
}

void fake_shoot(struct fake_camera *camera, int64_t stamp_ns, const void *pixels,
                enum fake_fate fate)
{
    unsigned index = 0;
    uint32_t row = camera->width_px * (camera->format == V4L2_PIX_FMT_GREY ? 1 : 2);
    assert_true(camera->streaming);
    while (index < camera->n_buffers && !camera->queued[index]) {
        index++;
    }
    uint32_t sequence = camera->sequence++;
    if (fate == FAKE_LOST || index == camera->n_buffers) {
        return;
    }
    memset(camera->memory[index], 0xa5,
           size_of(camera)); /* padding has other bytes than the picture */
    for (uint32_t i = 0; i < camera->height_px; i++) {
        memcpy(camera->memory[index] + i * camera->stride_bytes,
               (const uint8_t *)pixels + (size_t)i * row, row);
    }
    camera->queued[index] = false;
    camera->done[camera->n_done].index = index;
    camera->done[camera->n_done].sequence = sequence;
    camera->done[camera->n_done].stamp_ns = stamp_ns;
    camera->done[camera->n_done].bytes = size_of(camera) / (fate == FAKE_SHORT ? 2 : 1);
    camera->done[camera->n_done].damaged = fate == FAKE_DAMAGED;
    camera->n_done++;
    wake_camera(camera);
}

void fake_unplug(struct fake_camera *camera)
{
    camera->unplugged = true;
    wake_camera(camera);
}

void fake_break(struct fake_camera *camera)
{
    camera->broken = true;
    wake_camera(camera);
}

void fake_v4l2_assert_released(const struct fake_v4l2 *fake)
{
    for (int i = 0; i < FAKE_CAMERAS; i++) {
        assert_int_equal(fake->cameras[i].n_opened, 0);
        assert_int_equal(fake->cameras[i].n_mapped, 0);
        assert_false(fake->cameras[i].streaming);
    }
}
