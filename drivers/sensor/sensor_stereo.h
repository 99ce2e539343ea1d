/* What the stereo back ends share, wherever their pictures come from: options, matcher, frame. */
#ifndef ISO_DRIVERS_SENSOR_SENSOR_STEREO_H
#define ISO_DRIVERS_SENSOR_SENSOR_STEREO_H

#include "drivers/option.h"
#include "drivers/sensor/picture_stream.h"
#include "drivers/sensor/sensor.h"
#include "drivers/stereo/stereo.h"

struct iso_sensor_stereo {
    struct iso_stereo *stereo;
    struct iso_frame *frame;
    uint8_t *pictures[ISO_EYES]; /* [height_px * width_px] each, to be filled in */
    int width_px, height_px;
};

/* From the options calibration, near_mm, far_mm and confidence. -EINVAL with *fault naming the
 * option or what is wrong with the file; -ENOMEM. */
int iso_sensor_stereo_init(const char *owner, const struct iso_option *options, size_t n_options,
                           struct iso_sensor_stereo *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* An all-zero one is fine. */
void iso_sensor_stereo_done(struct iso_sensor_stereo *stereo);

/* The next pair of a stream of two cameras, matched: as the wait of a sensor. */
int iso_sensor_stereo_wait(struct iso_sensor_stereo *stereo, struct iso_picture_stream *stream,
                           const char *owner, int64_t deadline_ns, const struct iso_frame **frame,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* Model "stereo", the size, and the serial as given. */
void iso_sensor_stereo_describe(const struct iso_sensor_stereo *stereo, const char *serial,
                                struct iso_sensor_description *out);

#endif
