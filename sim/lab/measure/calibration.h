/* The calibration of a metric's scores: whether the measured false match rates are the promised
 * ones, how much information the scores have, and what decisions by them cost at the security
 * levels. */
#ifndef SIM_LAB_MEASURE_CALIBRATION_H
#define SIM_LAB_MEASURE_CALIBRATION_H

#include <stdbool.h>

#include "sim/lab/measure/detection_cost.h"
#include "sim/lab/measure/likelihood.h"
#include "sim/lab/measure/promise_curve.h"

struct sim_calibration {
    bool known;            /* false: the scores promise nothing, or there are none of one kind */
    double cllr, cllr_min; /* bits (likelihood.h) */
    struct sim_detection_cost cost[SIM_DETECTION_COSTS];
    struct sim_promise_point promise[SIM_PROMISE_POINTS];
};

/* Computes all of it from sorted scores. `n_people` and `distinct` are those of
 * sim_promise_curve_of(). Without scores of one of the kinds, *out is all zero. -ENOMEM. */
int sim_calibration_of(const struct sim_scores *scores, uint32_t n_people, double distinct,
                       struct sim_calibration *out) __attribute__((warn_unused_result));

#endif
