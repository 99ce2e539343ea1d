/* The sensor back end `v4l2-stereo`: two grey cameras that the kernel drives, whose pictures are
 * matched (drivers/stereo).
 *
 * Options:
 *   left, right   required: the two nodes, such as links in /dev/v4l/by-path
 *   calibration   required: the file of `isotherm-sim calibrate` (drivers/stereo/calibration.h); it
 *                 determines the size of the pictures
 *   fps           the frame rate to set; the cameras' own by default
 *   pair_ms       how far apart in time the two pictures of a pair may be (4). Cameras without a
 *                 common trigger need half a period, 17 at 30 pictures a second; the depths of a
 *                 thing that moves in between are wrong
 *   near_mm, far_mm   the range that is measured (300, 1200)
 *   confidence    the least correlation for a depth, 0..1 (0.75)
 *
 * Formats: GREY, Y16, Y12, Y10, YUYV, UYVY. A frame is that of the rectified left camera: its
 * depths, and its picture as intensity. Times, sequence, damaged pictures and a lost device are as
 * with `v4l2`, and follow the left camera. A picture without its partner is dropped, which leaves a
 * gap. */
#ifndef ISO_DRIVERS_SENSOR_V4L2_SENSOR_V4L2_STEREO_H
#define ISO_DRIVERS_SENSOR_V4L2_SENSOR_V4L2_STEREO_H

#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/v4l2/sensor_v4l2_system.h"

extern const struct iso_sensor_ops iso_sensor_v4l2_stereo_ops;

/* ops->open on another system than the kernel, which must outlive the sensor. */
int iso_sensor_v4l2_stereo_open_on(const struct iso_v4l2_system *system,
                                   const struct iso_option *options, size_t n_options,
                                   const struct iso_clock *clock, void **self,
                                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
