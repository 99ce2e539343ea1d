/* Learns the projection of a metric from residuals of templates. */
#ifndef SIM_TRAIN_METRIC_METRIC_LEARN_H
#define SIM_TRAIN_METRIC_METRIC_LEARN_H

#include <stddef.h>

#include "isotherm/metric.h"

/* Samples of known people: rows of residuals [n][n_values], and the person of each, from 0. */
struct sim_metric_samples {
    size_t n, n_people;
    const float *residual_mm;
    const size_t *person;
};

/* Fills in `between`, `centre` and `axis` of a metric. It first finds the principal components of
 * all samples by orthogonal iteration. In these coordinates it estimates the covariance within
 * people and the covariance between their means, by moments. Then it finds the basis in which
 * both are diagonal (Fukunaga 1990, 2.3). *explained (may be NULL) is the components' share of
 * the variance. The code is plain C, so that results do not depend on the installed BLAS. -EINVAL
 * for more dimensions than values; -ENODATA for fewer people than twice the dimensions or fewer
 * than two samples for each person on average; -ENOMEM. */
int sim_metric_learn(const struct sim_metric_samples *samples, struct iso_metric *metric,
                     double *explained) __attribute__((warn_unused_result));

/* Finds gain and bias so that, among strangers, a score gain * ratio + bias of at least s has
 * the rate 10^-s. They are a line through the tail of the strangers' log likelihood ratios, from
 * the rate 1e-2 to the rate of ten comparisons. `ratio` comes in any order and is sorted in place.
 * Mated comparisons are not used, because a threshold promises a rate of false matches. -ENODATA
 * for fewer than 10,000 comparisons, -EDOM if the rates do not fall. */
int sim_metric_calibrate(double *ratio, size_t n, float *gain, float *bias)
    __attribute__((warn_unused_result));

#endif
