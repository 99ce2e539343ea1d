/* What the back ends share whose frames come of a picture stream: the options of the stream, and
 * the operations that concern nothing else. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_PICTURE_SENSOR_H
#define ISO_DRIVERS_SENSOR_PICTURE_PICTURE_SENSOR_H

#include "drivers/base/option.h"
#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/picture/picture_stream.h"

/* The begin of such a back end's own object, so that a pointer to the one is a pointer to the
 * other. */
struct iso_picture_sensor {
    struct iso_picture_stream *stream;
};

/* The options fps (1..1000; 0 if not given) and pair_ms (0.1..1000; 4 if not given). -EINVAL with
 * *fault naming the option. */
int iso_picture_sensor_options(const char *owner, const struct iso_option *options,
                               size_t n_options, int *fps, int64_t *tolerance_ns,
                               struct iso_fault *fault) __attribute__((warn_unused_result));

/* Of the ops table (sensor.h); `self` begins with a struct iso_picture_sensor. */
int iso_picture_sensor_start(void *self, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_picture_sensor_stop(void *self);
int iso_picture_sensor_poll_fd(void *self);
void iso_picture_sensor_health(void *self, struct iso_sensor_device_health *out);

#endif
