/* A metric of two landmarks and three nodes, on which numbers can be worked out. */
#ifndef TESTS_CORE_MATCH_SMALL_METRIC_H
#define TESTS_CORE_MATCH_SMALL_METRIC_H

#include "isotherm/metric.h"

enum { RADII = 2, POINTS = 5, DIMENSIONS = 3, NODES = 3 };

/* Mean curves of landmarks 1 and 4 that do not lie in a plane; heights at three nodes of the upper
 * face; axes that depend on all of these. */
struct iso_metric *small_metric(void);

#endif
