/* The sensor back end `v4l2`: a depth camera that the kernel drives, such as Intel RealSense
 * through uvcvideo: a node with depths (Z16) and, if wanted, one with the infrared picture beside
 * it.
 *
 * Options:
 *   device      required: the depth node, such as /dev/video0 or a link in /dev/v4l/by-path
 *   camera      required: a file like the recording.ini of a recording (drivers/recording): the
 *               sensor's name, the lens, the image's size and the millimetres per count, which
 *               V4L2 does not provide
 *   ir_device   a node with the registered infrared picture, of the same size: GREY, Y16, Y12, Y10,
 *               YUYV or UYVY; without it frames carry no intensity
 *   fps         the frame rate to set; else the camera's own
 *   pair_ms     how far apart depth and infrared picture may be (4)
 *
 * A frame's time is the kernel's time stamp of the depth picture, on the injected clock; its
 * sequence counts on from stop to start, and has gaps where the kernel's has. A picture that comes
 * short or flagged as damaged is -EBADMSG; one without its infrared partner is dropped and a gap.
 * wait blocks in poll. A camera that is unplugged is -ENODEV from wait. */
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
