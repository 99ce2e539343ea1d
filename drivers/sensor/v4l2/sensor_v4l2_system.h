/* The system calls that the V4L2 back ends make, as a table. The back ends use iso_v4l2_kernel; a
 * test can use a table that simulates a camera. Its descriptors must be real ones, which poll and
 * epoll accept. */
#ifndef ISO_DRIVERS_SENSOR_V4L2_SENSOR_V4L2_SYSTEM_H
#define ISO_DRIVERS_SENSOR_V4L2_SENSOR_V4L2_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

struct iso_v4l2_system {
    void *context;
    int (*open)(void *context, const char *path); /* non-blocking; a descriptor or -errno */
    void (*close)(void *context, int fd);
    int (*ioctl)(void *context, int fd, unsigned long request, void *argument); /* 0 or -errno */
    /* Maps shared and readable memory; NULL on failure. */
    void *(*map)(void *context, int fd, size_t length, int64_t offset);
    void (*unmap)(void *context, void *at, size_t length);
    int64_t (*monotonic_ns)(void *context); /* the clock by which the kernel stamps pictures */
};

extern const struct iso_v4l2_system iso_v4l2_kernel;

#endif
