/* Cameras that are none: a stand-in for the kernel's video nodes (drivers/sensor/
 * sensor_v4l2_system.h), stricter than drivers are. A call out of order fails the test. */
#ifndef TESTS_DRIVERS_SENSOR_FAKE_V4L2_H
#define TESTS_DRIVERS_SENSOR_FAKE_V4L2_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/sensor/v4l2/sensor_v4l2_system.h"

enum { FAKE_CAMERAS = 2, FAKE_BUFFERS = 8 };

struct fake_camera {
    const char *path;
    uint32_t format; /* the only one it has */
    uint32_t width_px, height_px, stride_bytes;
    uint32_t capabilities;
    int open_error, start_error; /* -errno, or 0 */
    bool realtime_stamps;        /* a driver that keeps another clock */

    /* What happens next to a picture: see fake_shoot. */
    bool unplugged, broken;
    uint32_t sequence; /* of the next picture */

    /* Its own. */
    int fd;
    bool streaming;
    unsigned n_buffers, n_mapped;
    uint8_t *memory[FAKE_BUFFERS];
    bool queued[FAKE_BUFFERS];
    struct {
        uint32_t index, sequence, bytes;
        int64_t stamp_ns;
        bool damaged;
    } done[FAKE_BUFFERS]; /* filled and not yet taken, oldest first */
    unsigned n_done;
    int n_opened;
};

struct fake_v4l2 {
    struct fake_camera cameras[FAKE_CAMERAS];
    int64_t now_ns; /* the kernel's monotonic clock */
};

/* A table whose context is `fake`. */
struct iso_v4l2_system fake_v4l2_system(struct fake_v4l2 *fake);

/* What becomes of a picture on its way. */
enum fake_fate { FAKE_GOOD, FAKE_DAMAGED, FAKE_SHORT, FAKE_LOST };

/* The camera takes a picture at stamp_ns: rows of its stride, from pixels without padding (two
 * bytes or one each, as the format has). Lost: only the sequence goes on, as it does when no buffer
 * is free. */
void fake_shoot(struct fake_camera *camera, int64_t stamp_ns, const void *pixels,
                enum fake_fate fate);

/* Pulls the cable, or has the stream break: the camera's descriptor polls readable. */
void fake_unplug(struct fake_camera *camera);
void fake_break(struct fake_camera *camera);

/* Asserts that nothing is held: descriptors, buffers, maps. */
void fake_v4l2_assert_released(const struct fake_v4l2 *fake);

#endif
