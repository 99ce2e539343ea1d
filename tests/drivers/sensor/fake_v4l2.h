/* Simulated cameras: a stand-in for the kernel's video nodes (drivers/sensor/sensor_v4l2_system.h).
 * It is stricter than the kernel's drivers: a call in the wrong order fails the test. */
#ifndef TESTS_DRIVERS_SENSOR_FAKE_V4L2_H
#define TESTS_DRIVERS_SENSOR_FAKE_V4L2_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/sensor/v4l2/sensor_v4l2_system.h"

enum { FAKE_CAMERAS = 2, FAKE_BUFFERS = 8 };

struct fake_camera {
    const char *path;
    uint32_t format; /* the only format it has */
    uint32_t width_px, height_px, stride_bytes;
    uint32_t capabilities;
    int open_error, start_error; /* -errno, or 0 */
    bool realtime_stamps;        /* its driver does not stamp with the monotonic clock */

    /* Set by fake_unplug() and fake_break(). */
    bool unplugged, broken;
    uint32_t sequence; /* the sequence number of the next picture */

    /* The state below belongs to the simulation. */
    int fd;
    bool streaming;
    unsigned n_buffers, n_mapped;
    uint8_t *memory[FAKE_BUFFERS];
    bool queued[FAKE_BUFFERS];
    struct {
        uint32_t index, sequence, bytes;
        int64_t stamp_ns;
        bool damaged;
    } done[FAKE_BUFFERS]; /* filled buffers that were not taken yet, oldest first */
    unsigned n_done;
    int n_opened;
};

struct fake_v4l2 {
    struct fake_camera cameras[FAKE_CAMERAS];
    int64_t now_ns; /* the kernel's monotonic clock */
};

/* Returns the functions of the simulated nodes. Their context is `fake`, which must outlive them.
 */
struct iso_v4l2_system fake_v4l2_system(struct fake_v4l2 *fake);

/* The result of a picture. */
enum fake_fate { FAKE_GOOD, FAKE_DAMAGED, FAKE_SHORT, FAKE_LOST };

/* Makes the camera take a picture with the time stamp stamp_ns. `pixels` has rows without padding
 * (two bytes or one byte per pixel, by the format); the camera writes rows of its stride. FAKE_LOST
 * only increases the sequence number, as a real camera does when no buffer is free. */
void fake_shoot(struct fake_camera *camera, int64_t stamp_ns, const void *pixels,
                enum fake_fate fate);

/* Unplugs the camera, or breaks its stream. After both, poll reports the descriptor of the camera
 * as readable. */
void fake_unplug(struct fake_camera *camera);
void fake_break(struct fake_camera *camera);

/* Asserts that the back end holds no descriptor, buffer or map. */
void fake_v4l2_assert_released(const struct fake_v4l2 *fake);

#endif
