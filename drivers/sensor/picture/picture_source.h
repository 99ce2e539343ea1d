/* A camera that delivers pictures, independent of its driver. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_PICTURE_SOURCE_H
#define ISO_DRIVERS_SENSOR_PICTURE_PICTURE_SOURCE_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

/* A picture that was taken from a camera. */
struct iso_picture {
    const uint8_t *bytes;
    size_t stride_bytes; /* from row to row */
    size_t row_bytes;    /* bytes of a row without padding; at most two per pixel */
    uint32_t format;     /* V4L2_PIX_FMT_... of linux/videodev2.h */
    int width_px, height_px;
    uint32_t sequence;
    int64_t stamp_ns; /* of the kernel's monotonic clock */
};

/* The operations of one camera; each receives `self`. Only start and stop may block. */
struct iso_picture_source {
    void *self;

    /* Starts streaming. -ENODEV, -EBUSY, -ENOMEM, -EIO; nothing is held after a failure. */
    int (*start)(void *self, struct iso_fault *fault);

    /* Stops even if the device reports an error. -ENODEV, -EIO. */
    int (*stop)(void *self);

    /* Takes the oldest picture, which stays valid until give_back; the caller must call give_back.
     * -EAGAIN there is none yet, -EBADMSG a picture was damaged or short (it was given back
     * already), -EIO the stream broke, -ENODEV the device is gone. */
    int (*take)(void *self, struct iso_picture *out, struct iso_fault *fault);

    /* Gives the picture that was taken back to the camera. -ENODEV, -EIO. */
    int (*give_back)(void *self, struct iso_fault *fault);

    /* A descriptor that polls readable when take would not return -EAGAIN. */
    int (*fd)(void *self);
};

#endif
