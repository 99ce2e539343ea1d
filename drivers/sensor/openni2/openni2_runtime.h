/* OpenNI2's runtime: starting it, listing its devices, and describing its errors. For the sources
 * of this folder. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_RUNTIME_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_RUNTIME_H

#include "core/base/fault.h"
#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/openni2/openni2_api.h"

/* Converts a status to -ENODEV or -EIO. The fault is one line with `what` and the runtime's own
 * description. */
int iso__openni2_refuse(OniStatus status, const char *what, struct iso_fault *fault);

/* Starts the runtime. Each start needs an oniShutdown(); the last one ends the runtime. -ENODEV,
 * -EIO. */
int iso__openni2_start_runtime(struct iso_fault *fault) __attribute__((warn_unused_result));

/* Each start of the runtime takes most of a second and leaks some memory (138 kB with the drivers
 * of Debian 12). A runtime that found no device therefore stays loaded by iso__openni2_stay: the
 * next search is cheap, and its drivers notice a new device themselves. iso__openni2_leave undoes
 * this. */
void iso__openni2_stay(void);
void iso__openni2_leave(void);

/* Finds the device with this URI or serial number (NULL: the first one). Opens devices for a moment
 * to read serial numbers. -ENODEV with a fault that lists the devices, -EIO. */
int iso__openni2_find_device(const char *wanted, OniDeviceInfo *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Describes a file as a device. Uses its absolute path, because the runtime changes the working
 * directory at times. -ENODEV there is no such file, -EACCES, -EINVAL the path is too long, and the
 * errors of iso_file_check for what is not a regular file. */
int iso__openni2_find_file(const char *path, OniDeviceInfo *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads the serial number of an open device; "" if it has none. */
void iso__openni2_read_serial(OniDeviceHandle device, char serial[64]);

/* Calls the visitor for the devices that the runtime sees; ops->probe of the sensor class. */
int iso__openni2_probe(iso_sensor_visitor *visit, void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
