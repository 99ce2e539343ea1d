/* The sensor back end `libcamera-stereo`: two grey cameras through libcamera, as on a Raspberry Pi,
 * whose pictures are matched (drivers/stereo).
 *
 * Options: left and right are the cameras' names in libcamera (`cam --list` shows them; the name of
 * a USB camera contains its port, not a serial number). The others are those of `v4l2-stereo`
 * (sensor_v4l2_stereo.h): calibration, fps, pair_ms, near_mm, far_mm, confidence.
 *
 * libcamera runs a thread of its own, and writes its log to standard error (its environment
 * variable LIBCAMERA_LOG_LEVELS sets how much). Only one such sensor can be open in a process. */
#ifndef ISO_DRIVERS_SENSOR_LIBCAMERA_SENSOR_LIBCAMERA_STEREO_H
#define ISO_DRIVERS_SENSOR_LIBCAMERA_SENSOR_LIBCAMERA_STEREO_H

#include "drivers/sensor/contract/sensor.h"

extern const struct iso_sensor_ops iso_sensor_libcamera_stereo_ops;

#endif
