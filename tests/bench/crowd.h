/* Made-up people for benchmarks: as many as it takes, for the price of some random numbers. */
#ifndef TESTS_BENCH_CROWD_H
#define TESTS_BENCH_CROWD_H

#include <stdint.h>

#include "isotherm/metric.h"

/* A template of person `person`, made of the metric's mean curves, the person's own deviation (2 mm
 * a point) and that of the template number `take` (0.3 mm). Of no landmark that the metric does not
 * use is there more than zeros. The same every time. */
struct iso_template bench_template(const struct iso_metric *metric, uint64_t person, uint64_t take);

/* The vector of such a template by the metric's own statistics: what people differ by is normal
 * with variances `between`, templates of one person with variance 1. Quicker, and hard: people are
 * as alike as the metric thinks that people are. Scaled as iso_metric_project does. */
struct iso_metric_vector bench_vector(const struct iso_metric *metric, uint64_t person,
                                      uint64_t take);

#endif
