/* Vectors of a metric (isotherm/metric.h) whose numbers come from elsewhere than a template. */
#ifndef ISO_CORE_MATCH_METRIC_VECTOR_H
#define ISO_CORE_MATCH_METRIC_VECTOR_H

#include "isotherm/metric.h"

enum { ISO_METRIC_STEPS_ONE = ISO_METRIC_STEP_ONE_MAX - ISO_METRIC_STEP_MIN + 1 };

/* What the likelihood of a vector needs of a metric, for each step of one template. It is the same
 * for all vectors, so that a program with many of them computes it once. */
struct iso_metric_steps {
    double log_volume[ISO_METRIC_STEPS_ONE]; /* logarithm of the product of the variances */
    double inverse[ISO_METRIC_DIMENSIONS_MAX][ISO_METRIC_STEPS_ONE]; /* 1 / the variances */
};

/* Fills in the numbers of a metric. */
void iso_metric_steps_fill(const struct iso_metric *metric, struct iso_metric_steps *steps);

/* Computes step, weight and scale of a vector of one template from its numbers. `steps` is of this
 * metric. */
void iso_metric_vector_judge(const struct iso_metric *metric, const struct iso_metric_steps *steps,
                             struct iso_metric_vector *vector);

#endif
