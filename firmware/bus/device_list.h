/* Lists the devices that the sensor drivers of this build find, for programs: `isothermd
 * --list-devices`. Needs no configuration and no running daemon, and opens no camera for use. */
#ifndef ISO_FIRMWARE_BUS_DEVICE_LIST_H
#define ISO_FIRMWARE_BUS_DEVICE_LIST_H

#include <stdio.h>

#include "core/base/fault.h"

/* Writes one JSON object a line: {"sensor", "id", "label"} for each device, with "kind": "depth"
 * for a depth camera, or {"sensor", "fault"} for a driver that cannot look for its devices. Both
 * have "code" if there is a fault with a code (core/base/fault_code.h). Drivers without devices
 * (replay) are left out. May block for some seconds. -EIO the stream cannot be written. */
int iso_device_list_print(FILE *out, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
