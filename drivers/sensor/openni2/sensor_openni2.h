/* The sensor back end `openni2`: depth cameras behind OpenNI 2 (Orbbec Astra, PrimeSense Carmine,
 * Asus Xtion, whatever has a driver for it), and its recordings.
 *
 * Options, all optional:
 *   device      URI (as doctor and `isotherm-sim record --list` show it) or serial number; the
 *               first device if not given
 *   path        an .oni file instead of a device
 *   mode        WIDTHxHEIGHT@HZ, such as 640x480@30; as the device has it if not given
 *   unit        finest (default) | 100um | 1mm: what a count of depth is worth
 *   intensity   no (default) | ir: of the depth sensor itself, registered by nature | color: grey
 * of the colour camera, if the device can register depths to it intrinsics  FX FY CX CY in pixels,
 * from a calibration; from the field of view that the device tells if not given, with the principal
 * point in the middle record      an .oni file that the runtime writes from start to stop pace,
 * loop  of a file: as of the sensor replay
 *
 * A device is waited for in slices of a few milliseconds, so that an unplugged cable is noticed in
 * time. The runtime keeps the newest frame only: who is late loses the older ones, and finds a gap
 * in the sequence. Depth and intensity are paired by the device's time stamps; a depth frame whose
 * partner does not come is dropped. t_ns is the device's time on the injected clock (timeline.h).
 * Mirroring is turned off, or undone.
 *
 * A file is played frame by frame and never waited for in real time: it has next_due_ns, and from
 * the end on it has nothing to come. A start begins it anew.
 *
 * The runtime has threads of its own, and runs as long as a sensor is open, or has been looked for
 * in vain and is not found yet. It looks for its drivers beside the path that it was loaded from,
 * and changes the working directory for a moment when it starts. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_SENSOR_OPENNI2_H
#define ISO_DRIVERS_SENSOR_OPENNI2_SENSOR_OPENNI2_H

#include "drivers/sensor/contract/sensor.h"

extern const struct iso_sensor_ops iso_sensor_openni2_ops;

/* Ends a runtime that has stayed on because no device was found. Not needed before the end of a
 * process. */
void iso_sensor_openni2_forget(void);

#endif
