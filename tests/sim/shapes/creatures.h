/* Small corpora of creatures for tests. */
#ifndef TESTS_SIM_SHAPES_CREATURES_H
#define TESTS_SIM_SHAPES_CREATURES_H

#include <stddef.h>

#include "sim/shapes/match/match.h"
#include "sim/shapes/study/study.h"

/* Generates creatures of 400 vertices in a directory: 9 of a preset `plain`, 24 of each class of
 * `textured`. format: NULL for that of the preset. A failure ends the test. */
void make_creatures(const char *out, const char *preset, const char *format, size_t classes,
                    int threads);

/* Runs a study. *printed receives what it prints; free() it. */
int run_study(const struct sim_shapes_study_options *options, char **printed,
              struct iso_fault *fault);

/* Matches two shapes and returns the mean geodesic error that is printed. *within, if not NULL,
 * receives the share of points within 0.25. A failure ends the test. */
double match_error(const struct sim_match_options *options, double *within);

#endif
