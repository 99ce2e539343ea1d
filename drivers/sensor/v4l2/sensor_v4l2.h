/* The sensor back end `v4l2`: a depth camera that the kernel drives, such as an Intel RealSense
 * through uvcvideo. It reads a node that gives depths (Z16) and, if wanted, a second node that
 * gives the infrared picture.
 *
 * Options:
 *   device      required: the depth node, such as /dev/video0 or a link in /dev/v4l/by-path
 *   camera      required: a file like the recording.ini of a recording (drivers/recording): the
 *               sensor's name, the lens, the image's size and the millimetres per count, which
 *               V4L2 does not provide
 *   ir_device   a node with the registered infrared picture, of the same size: GREY, Y16, Y12, Y10,
 *               YUYV or UYVY; without it frames carry no intensity
 *   fps         the frame rate to set; the camera's own by default
 *   pair_ms     how far apart in time depth and infrared picture may be (4)
 *
 * A frame's time is the kernel's time stamp of the depth picture, on the injected clock; its
 * sequence continues after a stop and a start, and has gaps where the kernel's has. For a picture
 * that is short or flagged as damaged wait returns -EBADMSG. A depth picture without its infrared
 * partner is dropped, which leaves a gap. wait blocks in poll. After a camera was unplugged, wait
 * returns -ENODEV. */
#ifndef ISO_DRIVERS_SENSOR_V4L2_SENSOR_V4L2_H
#define ISO_DRIVERS_SENSOR_V4L2_SENSOR_V4L2_H

#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/v4l2/sensor_v4l2_system.h"

extern const struct iso_sensor_ops iso_sensor_v4l2_ops;

/* ops->open on another system than the kernel, which must outlive the sensor. */
int iso_sensor_v4l2_open_on(const struct iso_v4l2_system *system, const struct iso_option *options,
                            size_t n_options, const struct iso_clock *clock, void **self,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
