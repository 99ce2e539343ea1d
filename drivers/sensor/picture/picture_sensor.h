/* The common part of the back ends whose frames come from a picture stream: the options of the
 * stream, and the operations that need only the stream. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_PICTURE_SENSOR_H
#define ISO_DRIVERS_SENSOR_PICTURE_PICTURE_SENSOR_H

#include "drivers/base/option.h"
#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/picture/picture_stream.h"

/* The first member of such a back end's own object, so that a pointer to one is also a pointer to
 * the other. */
struct iso_picture_sensor {
    struct iso_picture_stream *stream;
};

/* The options of the stream, for the tables of the back ends. */
/* clang-format off */
#define ISO_PICTURE_SENSOR_OPTIONS \
    {.name = "fps", .kind = ISO_OPTION_NUMBER, .min = 1, .max = 1000, .standard = "", \
     .help = "frames a second to ask for; the camera's own rate if empty"}, \
    {.name = "pair_ms", .kind = ISO_OPTION_NUMBER, .min = 0.1, .max = 1000, .standard = "4", \
     .help = "largest time between two pictures that belong together"}
/* clang-format on */

/* Reads them: frames a second (0 if not given), and the tolerance in nanoseconds. `set` has been
 * checked. */
void iso_picture_sensor_options(const struct iso_option_set *set, int *fps, int64_t *tolerance_ns);

/* Operations for the ops table (sensor.h); `self` begins with a struct iso_picture_sensor. */
int iso_picture_sensor_start(void *self, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_picture_sensor_stop(void *self);
int iso_picture_sensor_poll_fd(void *self);
void iso_picture_sensor_set_interval(void *self, int64_t interval_ns);
void iso_picture_sensor_health(void *self, struct iso_sensor_device_health *out);

#endif
