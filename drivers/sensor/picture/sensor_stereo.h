/* The common part of the stereo back ends, independent of the source of their pictures: options,
 * matcher, frame. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_SENSOR_STEREO_H
#define ISO_DRIVERS_SENSOR_PICTURE_SENSOR_STEREO_H

#include "drivers/base/option.h"
#include "drivers/sensor/picture/picture_sensor.h"
#include "drivers/stereo/stereo.h"

/* The first member of a stereo back end's own object. */
struct iso_sensor_stereo {
    struct iso_picture_sensor base;
    const char *owner; /* of the faults: "sensor v4l2-stereo" */
    struct iso_stereo *stereo;
    struct iso_frame *frame;
    uint8_t *pictures[ISO_EYES]; /* [height_px * width_px] each: the pictures to match */
    int width_px, height_px;
    char calibration[96];                 /* as in the description */
    enum iso_fault_code calibration_code; /* the same */
};

/* The table of options of every stereo back end: left, right, calibration, fps, pair_ms, near_mm,
 * far_mm and confidence. The back end interprets the texts of left and right. */
extern const struct iso_option_spec iso_sensor_stereo_options[];

/* The options of the cameras. */
struct iso_sensor_stereo_cameras {
    const char *ids[ISO_EYES]; /* left, right: the options' texts */
    int fps;                   /* 0: the cameras' own rate */
    int64_t tolerance_ns;
};

/* Loads the module that matches the pictures. The errors of iso_module_load, with a fault that
 * begins with `owner`. */
int iso_sensor_stereo_load(const char *owner, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Makes the common part from options that agree with the table. Opens no stream yet. -EINVAL the
 * calibration is wrong; -ENOENT its file does not exist; -ENOMEM; the errors of
 * iso_sensor_stereo_load. `owner` outlives the object. */
int iso_sensor_stereo_init(const char *owner, const struct iso_option *options, size_t n_options,
                           struct iso_sensor_stereo *out, struct iso_sensor_stereo_cameras *cameras,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* The check of a stereo back end (sensor.h): whether iso_sensor_stereo_init accepts the options.
 * The errors of that function. */
int iso_sensor_stereo_check(const char *owner, const struct iso_option *options, size_t n_options,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

/* Releases everything and closes the stream. An all-zero object is fine. */
void iso_sensor_stereo_done(struct iso_sensor_stereo *stereo);

/* Takes the next pair of the stream and matches it: the operation `wait` of a sensor whose object
 * begins with a struct iso_sensor_stereo.
 */
int iso_sensor_stereo_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* Fills in the description: the model "stereo", the size, the calibration, and this serial. */
void iso_sensor_stereo_describe(const struct iso_sensor_stereo *stereo, const char *serial,
                                struct iso_sensor_description *out);

#endif
