/* The back end v4l2 with two simulated cameras (fake_v4l2.h): a depth camera and an infrared
 * camera. */
#ifndef TESTS_DRIVERS_SENSOR_V4L2_RIG_H
#define TESTS_DRIVERS_SENSOR_V4L2_RIG_H

#include "drivers/sensor/contract/sensor.h"
#include "tests/drivers/sensor/fake_v4l2.h"

extern struct fake_v4l2 v4l2_fake;
extern int64_t v4l2_now_ns;          /* the time of the injected clock */
extern void *v4l2_scratch;           /* a directory with camera.ini */
extern const char v4l2_camera_ini[]; /* the text of camera.ini */

/* cmocka set-up and tear-down. The tear-down fails if the back end still holds a resource. */
int v4l2_set_up(void **state);
int v4l2_tear_down(void **state);

/* Sets both clocks to this many milliseconds after the beginning. */
void v4l2_at(int64_t ms);

/* Opens the depth camera, with_ir also the infrared one. Returns the error of the opening. */
int v4l2_open_sensor(bool with_ir, struct iso_sensor **sensor, struct iso_fault *fault);
/* Opens and starts the cameras. An error fails the test. */
struct iso_sensor *v4l2_started(bool with_ir);

/* Makes a camera take picture number `picture`, with a time stamp of `ms` milliseconds after the
 * beginning. */
void v4l2_shoot_depth(int picture, int64_t ms, enum fake_fate fate);
void v4l2_shoot_ir(int picture, int64_t ms, enum fake_fate fate);

/* Asserts that the frame has the pixels of the depth picture and, if it has an intensity, of the
 * infrared picture with this number, and the time `ms` on the injected clock. */
void v4l2_assert_frame(const struct iso_frame *frame, int picture, int64_t ms);

/* Fetches a frame without waiting: the deadline is now. Returns the result of iso_sensor_wait. */
int v4l2_look(struct iso_sensor *sensor, const struct iso_frame **frame, struct iso_fault *fault);

#endif
