/* Completes a vector of a metric (isotherm/metric.h) of which only the numbers `mean` are known,
 * and not the template that they come from. */
#ifndef ISO_CORE_MATCH_METRIC_VECTOR_H
#define ISO_CORE_MATCH_METRIC_VECTOR_H

#include "isotherm/metric.h"

enum { ISO_METRIC_STEPS_ONE = ISO_METRIC_STEP_ONE_MAX - ISO_METRIC_STEP_MIN + 1 };

/* Numbers from which the likelihood of a vector is computed. They depend on the metric and on the
 * step, but not on the vector. The structure has them for every step that one template may have. A
 * program that completes many vectors computes them only once. */
struct iso_metric_steps {
    double log_volume[ISO_METRIC_STEPS_ONE]; /* logarithm of the product of the variances */
    double inverse[ISO_METRIC_DIMENSIONS_MAX][ISO_METRIC_STEPS_ONE]; /* 1 / the variances */
};

/* Computes these numbers for a metric. */
void iso_metric_steps_fill(const struct iso_metric *metric, struct iso_metric_steps *steps);

/* Computes step, weight and scale of a vector of one template from its numbers. `steps` is of this
 * metric. */
void iso_metric_vector_judge(const struct iso_metric *metric, const struct iso_metric_steps *steps,
                             struct iso_metric_vector *vector);

#endif
