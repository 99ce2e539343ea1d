/* The sensor back end `openni2`: depth cameras with a driver for OpenNI 2 (such as Orbbec Astra,
 * PrimeSense Carmine and Asus Xtion), and the recordings of OpenNI 2.
 *
 * The table of its options is in openni2_options.c; all are optional. Without `device` and `path`
 * it opens the first camera; `isotherm doctor` and `isotherm-sim record --list` show the URIs.
 * `intensity = ir` is the image of the depth sensor itself, which needs no registration; `color` is
 * the luma of the colour camera, if the device can register depths to it. Without `intrinsics` and
 * `camera` the focal lengths follow from the field of view that the device reports, and the
 * principal point is the middle. `record` is for tools: the runtime writes that .oni file from
 * start to stop.
 *
 * A wait for a device consists of slices of at most 20 ms, so that an unplugged cable is noticed in
 * time. The runtime keeps only the newest frame: a caller that is late loses the older ones and
 * finds a gap in the sequence. Depth and intensity are paired by the device's time stamps; a depth
 * frame whose partner does not come is dropped. t_ns is the device's time on the injected clock
 * (timeline.h). Mirroring is turned off, or undone.
 *
 * A file is played frame by frame without blocking: the back end has next_due_ns, and after the end
 * there are no more frames. A start plays the file from its beginning.
 *
 * The runtime has threads of its own. It runs as long as a sensor is open, and after a search that
 * found no device. It finds its drivers next to the path from which it was loaded, and changes the
 * working directory for a moment when it starts. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_SENSOR_OPENNI2_H
#define ISO_DRIVERS_SENSOR_OPENNI2_SENSOR_OPENNI2_H

#include "drivers/sensor/contract/sensor.h"

extern const struct iso_sensor_ops iso_sensor_openni2_ops;

/* Ends a runtime that still runs because no device was found. Not needed at the end of a process.
 */
void iso_sensor_openni2_forget(void);

#endif
