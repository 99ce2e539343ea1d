/* The learning in a metric: from residuals of templates to a projection. */
#ifndef SIM_TRAIN_METRIC_METRIC_LEARN_H
#define SIM_TRAIN_METRIC_METRIC_LEARN_H

#include <stddef.h>

#include "isotherm/metric.h"

/* Samples of known people: rows of residuals [n][n_values], and whose each is, from 0. */
struct sim_metric_samples {
    size_t n, n_people;
    const float *residual_mm;
    const size_t *person;
};

/* Fills in between, centre and axis of a metric. Principal components of all samples first, by
 * orthogonal iteration; among them the covariance within people and that between their means, by
 * moments; then the basis in which both are diagonal (Fukunaga 1990, 2.3). *explained (may be NULL)
 * is the components' share of the variance. In plain C, so that results do not depend on the BLAS
 * that is installed. -EINVAL for more dimensions than values; -ENODATA for fewer people than twice
 * the dimensions or fewer than two samples a person on average; -ENOMEM. */
int sim_metric_learn(const struct sim_metric_samples *samples, struct iso_metric *metric,
                     double *explained) __attribute__((warn_unused_result));

/* Gain and bias such that among strangers a score gain * ratio + bias of s or more is as rare as
 * 10^-s: a line through the tail of their log likelihood ratios, from the rate 1e-2 to that of ten
 * comparisons. `ratio` is sorted. Mated comparisons are not used: a threshold promises a rate of
 * false matches. -ENODATA for fewer than 10,000 comparisons, -EDOM if they do not fall off.
 */
int sim_metric_calibrate(double *ratio, size_t n, float *gain, float *bias)
    __attribute__((warn_unused_result));

#endif
