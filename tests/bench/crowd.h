/* Made-up people for benchmarks, from random numbers: any number of them at little cost. */
#ifndef TESTS_BENCH_CROWD_H
#define TESTS_BENCH_CROWD_H

#include <stdint.h>

#include "isotherm/metric.h"

/* A template of person `person`: the metric's mean curves with random deviations of the person (2
 * mm in each coordinate of each point) and of the template number `take` (0.3 mm). Landmarks that
 * the metric does not use have zeros. The result is the same every time. */
struct iso_template bench_template(const struct iso_metric *metric, uint64_t person, uint64_t take);

/* The vector of a template by the metric's own statistics: people differ by a normal distribution
 * with the variances `between`, and templates of one person with the variance 1. This is quicker
 * than bench_template, and harder for a search: people are as similar as the metric assumes. The
 * vector is scaled as by iso_metric_project. */
struct iso_metric_vector bench_vector(const struct iso_metric *metric, uint64_t person,
                                      uint64_t take);

#endif
