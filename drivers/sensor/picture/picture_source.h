/* A camera as the sensors see it that take pictures, whatever drives it. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_PICTURE_SOURCE_H
#define ISO_DRIVERS_SENSOR_PICTURE_PICTURE_SOURCE_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

/* A picture that was taken from a camera. */
struct iso_picture {
    const uint8_t *bytes;
    size_t stride_bytes; /* from row to row */
    size_t row_bytes;    /* of them pixels; at most two a pixel */
    uint32_t format;     /* V4L2_PIX_FMT_... of linux/videodev2.h */
    int width_px, height_px;
    uint32_t sequence;
    int64_t stamp_ns; /* of the kernel's monotonic clock */
};

/* The operations of one camera; `self` is theirs. None blocks for more than start and stop need. */
struct iso_picture_source {
    void *self;

    /* -ENODEV, -EBUSY, -ENOMEM, -EIO; nothing is held after a failure. */
    int (*start)(void *self, struct iso_fault *fault);

    /* Stops whatever the device says. -ENODEV, -EIO. */
    int (*stop)(void *self);

    /* The oldest picture; it stays until give_back, which has to follow. -EAGAIN there is none yet,
     * -EBADMSG one came damaged or short (and was given back), -EIO the stream broke, -ENODEV the
     * device is gone. */
    int (*take)(void *self, struct iso_picture *out, struct iso_fault *fault);

    /* -ENODEV, -EIO. */
    int (*give_back)(void *self, struct iso_fault *fault);

    /* A descriptor that polls readable when take would not be -EAGAIN. */
    int (*fd)(void *self);
};

#endif
