/* The options of the sensor back end `openni2` (sensor_openni2.h), for sensor_openni2.c. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_OPTIONS_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "drivers/sensor/contract/camera_file.h"
#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/openni2/openni2_wish.h"
#include "isotherm/camera.h"

/* Ended by an entry without a name. */
extern const struct iso_option_spec iso__openni2_options[];

/* The settings from the options. */
struct iso__openni2_settings {
    struct iso__openni2_wish wish; /* points to the texts below */
    char *path, *device, *record;  /* NULL: not given */
    bool realtime;                 /* a file: frames are due by their time stamps */
    bool calibrated;               /* the option `intrinsics` is given: */
    struct iso_camera lens;        /* its focal lengths and principal point; the rest is 0 */
    bool has_camera;               /* the option `camera` is given: */
    struct iso_camera_file camera;
};

/* Reads the options. -EINVAL with a fault if one is bad, -ENOMEM, and the errors of
 * iso_camera_file_read; *settings holds nothing then. */
int iso__openni2_settings_init(struct iso__openni2_settings *settings,
                               const struct iso_option *options, size_t n_options,
                               struct iso_fault *fault) __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso__openni2_settings_done(struct iso__openni2_settings *settings);

#endif
