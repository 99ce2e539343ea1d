/* A metric of two landmarks and three nodes. It is so small that a test can calculate its results
 * by hand. */
#ifndef TESTS_CORE_MATCH_SMALL_METRIC_H
#define TESTS_CORE_MATCH_SMALL_METRIC_H

#include "isotherm/metric.h"

enum { RADII = 2, POINTS = 5, DIMENSIONS = 3, NODES = 3 };

/* Returns the metric; free it with iso_metric_free(). The mean curves of landmarks 1 and 4 do not
 * lie in a plane. The upper face has heights at three nodes. The axes depend on all of these
 * values. */
struct iso_metric *small_metric(void);

/* Makes a template for this metric that has the mean curves, turned and shifted, and the mean
 * heights. Its curves of other landmarks do not count. */
struct iso_template small_template(const struct iso_metric *m, double turn_rad);

#endif
