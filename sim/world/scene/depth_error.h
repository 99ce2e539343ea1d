/* Measures the errors of a sensor model's depths on faces at several distances, against the
 * rendered truth. */
#ifndef SIM_WORLD_SCENE_DEPTH_ERROR_H
#define SIM_WORLD_SCENE_DEPTH_ERROR_H

#include <stddef.h>

#include "core/base/fault.h"
#include "sim/world/face/ict.h"
#include "sim/world/sensor/sensor.h"

/* Face pixels: skin within this distance of the nose tip that the sensor's camera sees. */
#define SIM_DEPTH_ERROR_RADIUS_MM 90.0

struct sim_depth_error {
    double distance_mm; /* of the nose tip */
    size_t faces, pixels, holes;
    double bias_mm, rms_mm;   /* of measured - true, over measured pixels */
    double median_mm, p95_mm; /* of the absolute error */
    double gross;             /* share of measured pixels more than 5 mm off */
};

struct sim_depth_error_options {
    const struct sim_ict *ict;
    const struct sim_sensor *sensor;
    size_t faces; /* people, each in a different pose within 10 degrees */
    uint64_t seed;
    double noise_scale; /* as in sim_sensor_measure */
    /* Called with each frame and the view it was measured from; may be NULL. */
    void (*show)(void *context, const struct sim_view *view, const struct iso_frame *frame);
    void *context;
};

/* Renders neutral faces at a distance and measures them. -ENOMEM; -EINVAL if the sensor measured no
 * pixel of any face. */
int sim_depth_error_measure(const struct sim_depth_error_options *options, double distance_mm,
                            struct sim_depth_error *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
