/* OpenNI2's runtime: starting it, listing its devices, and describing its errors. For the sources
 * of this folder. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_RUNTIME_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_RUNTIME_H

#include "core/base/fault.h"
#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/openni2/openni2_api.h"

/* A status as an errno (-ENODEV or -EIO), with a fault that says what was tried and, on one line,
 * the runtime's own words. */
int iso__openni2_refuse(OniStatus status, const char *what, struct iso_fault *fault);

/* Starts the runtime; each start is paired with an oniShutdown(), the last of which ends it. -EIO.
 */
int iso__openni2_start_runtime(struct iso_fault *fault) __attribute__((warn_unused_result));

/* Each start of the runtime takes most of a second and leaks some memory (138 kB with the drivers
 * of Debian 12). A runtime that found no device therefore stays loaded: the next search is cheap,
 * and its drivers notice a new device themselves. iso__openni2_leave unloads it. */
void iso__openni2_stay(void);
void iso__openni2_leave(void);

/* The device of this URI or serial number (NULL: the first there is). Opens devices for a moment to
 * read serial numbers. -ENODEV with a fault that lists what there is, -EIO. */
int iso__openni2_find_device(const char *wanted, OniDeviceInfo *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A file as a device: by its full name, since the runtime changes the working directory at times.
 * -ENODEV, -EACCES, -EINVAL the name is too long. */
int iso__openni2_find_file(const char *path, OniDeviceInfo *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* "" if it has none. */
void iso__openni2_read_serial(OniDeviceHandle device, char serial[64]);

/* Calls the visitor for the devices that the runtime sees; ops->probe of the sensor class. */
int iso__openni2_probe(iso_sensor_visitor *visit, void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
