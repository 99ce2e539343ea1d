/* The false match rate that each score promises, and the measured rate, with intervals over people.
 *
 * A score of s promises that non-mated comparisons reach it at the rate 10^-s. */
#ifndef SIM_LAB_MEASURE_PROMISE_CURVE_H
#define SIM_LAB_MEASURE_PROMISE_CURVE_H

#include "sim/lab/measure/det.h"

/* Ten points for each decade of the promise, from 1 to 1e-5. */
enum { SIM_PROMISE_STEPS = 10, SIM_PROMISE_POINTS = 5 * SIM_PROMISE_STEPS + 1 };

struct sim_promise_point {
    double score;    /* place in the array / SIM_PROMISE_STEPS */
    double promised; /* 10^-score */
    double fmr;      /* share of the non-mated comparisons that reach the score; NaN without any */
    struct sim_interval interval; /* 95 % */
};

/* Measures the curve. The people of the probes, whose numbers are below n_people, are resampled
 * with all their comparisons (Bolle, Ratha and Pankanti 2004). If no comparison
 * reaches a score, none does in any resample, and the rate would seem to be 0 for certain.
 * Therefore the interval is extended to contain Wilson's interval of `distinct` independent
 * comparisons. `distinct` is the number of different comparisons; `scores` may contain some of them
 * several times. The scores must be sorted (sim_scores_sort). The same scores give the same
 * intervals. -ENOMEM. */
int sim_promise_curve_of(const struct sim_scores *scores, uint32_t n_people, double distinct,
                         struct sim_promise_point out[SIM_PROMISE_POINTS])
    __attribute__((warn_unused_result));

#endif
