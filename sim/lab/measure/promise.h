/* The error rates that calibrated scores promise, and the measured rates. Among strangers who
 * look alike, a score of s or more should have a probability of 10^-s with every sensor
 * (isotherm/metric.h). */
#ifndef SIM_LAB_MEASURE_PROMISE_H
#define SIM_LAB_MEASURE_PROMISE_H

#include "sim/lab/measure/det.h"

enum { SIM_PROMISES = 4 };

struct sim_promise {
    double score;                /* 1, 2, 3, 4: the promised FMRs are 1e-1 to 1e-4 */
    struct sim_rate false_match; /* non-mated comparisons that reach this score */
    struct sim_rate non_match;   /* mated comparisons that do not reach it */
};

/* Counts the rates in the scores of a metric, which must be sorted (sim_scores_sort). */
void sim_promises_of(const struct sim_scores *scores, struct sim_promise out[SIM_PROMISES]);

#endif
