/* The back end v4l2 before two cameras that are none (fake_v4l2.h): a depth camera, and one of
 * infrared pictures. */
#ifndef TESTS_DRIVERS_SENSOR_V4L2_RIG_H
#define TESTS_DRIVERS_SENSOR_V4L2_RIG_H

#include "drivers/sensor/contract/sensor.h"
#include "tests/drivers/sensor/fake_v4l2.h"

extern struct fake_v4l2 v4l2_fake;
extern int64_t v4l2_now_ns;          /* of the injected clock */
extern void *v4l2_scratch;           /* a directory with camera.ini */
extern const char v4l2_camera_ini[]; /* its text */

/* cmocka set-up and tear-down; the latter fails if something is still open. */
int v4l2_set_up(void **state);
int v4l2_tear_down(void **state);

/* Sets both clocks: this many milliseconds after the beginning. */
void v4l2_at(int64_t ms);

int v4l2_open_sensor(bool with_ir, struct iso_sensor **sensor, struct iso_fault *fault);
struct iso_sensor *v4l2_started(bool with_ir);

/* Has a camera make a picture, stamped with this time. */
void v4l2_shoot_depth(int picture, int64_t ms, enum fake_fate fate);
void v4l2_shoot_ir(int picture, int64_t ms, enum fake_fate fate);

/* The frame is made of these pictures, pixel by pixel, and of that time. */
void v4l2_assert_frame(const struct iso_frame *frame, int picture, int64_t ms);

/* A deadline in the past: only looks. */
int v4l2_look(struct iso_sensor *sensor, const struct iso_frame **frame, struct iso_fault *fault);

#endif
