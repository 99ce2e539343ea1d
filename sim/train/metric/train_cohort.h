/* The cohort for the normalisation of scores (core/match/cohort.h): templates of rendered people
 * who are in no gallery, made by the same extractor as all other templates. */
#ifndef SIM_TRAIN_METRIC_TRAIN_COHORT_H
#define SIM_TRAIN_METRIC_TRAIN_COHORT_H

#include "isotherm/extract.h"
#include "sim/world/face/ict.h"
#include "sim/world/sensor/sensor.h"

enum { SIM_COHORT_SENSORS_MAX = 8 };

struct sim_train_cohort_options {
    const struct sim_ict *ict;
    const struct iso_head_model *model;
    struct iso_extract_options extract; /* the training sets its sensor and clock */
    const struct sim_sensor *sensors[SIM_COHORT_SENSORS_MAX]; /* used for the people in turn */
    int n_sensors;
    uint32_t n_people; /* ISO_COHORT_MIN..ISO_COHORT_MAX */
    uint64_t seed;
};

struct sim_train_cohort_report {
    uint32_t n_people, n_frames; /* templates; all frames, including refused ones */
};

/* Makes one template from one frame of each of n_people people of the population "train". They
 * are at rest or have a mild expression, and look nearly straight ahead. They have hair, clothes
 * and a room behind them; a sensor that shows only the face gets neither clothes nor room. If the
 * extractor refuses a frame, another frame is taken on another day, up to three frames in all;
 * then the next person takes that place. The same arguments give the same templates. *out is one
 * array of n_people templates; the caller wipes it and frees it with free(). -EINVAL for options
 * out of range, -ENODATA if 2 * n_people people do not give n_people templates, or errors of
 * rendering and extraction; each with a fault. */
int sim_train_cohort(const struct sim_train_cohort_options *options, struct iso_template **out,
                     struct sim_train_cohort_report *report, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
