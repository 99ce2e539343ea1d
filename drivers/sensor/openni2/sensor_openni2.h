/* The sensor back end `openni2`: depth cameras behind OpenNI 2 (Orbbec Astra, PrimeSense Carmine,
 * Asus Xtion, whatever has a driver for it), and its recordings.
 *
 * The table of its options stands in openni2_options.c; all are optional. Without `device` and
 * `path` it opens the first camera; `isotherm doctor` and `isotherm-sim record --list` show the
 * URIs. `intensity = ir` is the image of the depth sensor itself, registered by nature; `color` is
 * the grey of the colour camera, if the device can register depths to it. Without `intrinsics` and
 * `camera` the lens follows from the field of view that the device tells, with the principal point
 * in the middle. `record` is for tools: the runtime writes that .oni file from start to stop.
 *
 * A wait for a device consists of slices of a few milliseconds, so that an unplugged cable is
 * noticed in time. The runtime keeps only the newest frame: a caller that is late loses the older
 * ones and finds a gap in the sequence. Depth and intensity are paired by the device's time stamps;
 * a depth frame whose partner does not come is dropped. t_ns is the device's time on the injected
 * clock (timeline.h). Mirroring is turned off, or undone.
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
