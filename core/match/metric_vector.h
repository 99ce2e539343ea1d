/* Vectors of a metric (isotherm/metric.h): those of many templates at once, and one of which only
 * the numbers `mean` are known, and not the template that they come from. */
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

/* Most templates that are projected at once. The projection is larger than a cache, so that reading
 * it takes most of the time of projecting one template. */
enum { ISO_METRIC_ROWS = 16 };

/* Makes the vectors of n templates (1..ISO_METRIC_ROWS) from their residuals, the same as
 * iso_metric_project() makes, to the bit. residual_mm is [ISO_METRIC_ROWS][metric->n_values], in
 * which the first n rows are those of iso_metric_residuals(). `steps` is of this metric. */
void iso_metric_project_rows(const struct iso_metric *metric, const struct iso_metric_steps *steps,
                             const float *residual_mm, int n, struct iso_metric_vector *out);

/* The numbers of these vectors alone, for each kind of processor; the results are the same to the
 * bit. (On arm64 the compiler may join a product and a sum into one instruction.) */
typedef void iso_project_function(const struct iso_metric *metric, const float *residual_mm, int n,
                                  float mean[][ISO_METRIC_DIMENSIONS_MAX]);

iso_project_function iso__project_baseline;
iso_project_function iso__project_avx2; /* x86-64 only */

#endif
