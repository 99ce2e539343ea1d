/* Functions that the tests of the site's index share: a metric of a few dimensions, and people
 * whose vectors are given by their number. */
#ifndef TESTS_FIRMWARE_SITE_SITE_RIG_H
#define TESTS_FIRMWARE_SITE_SITE_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/site/site_index.h"

enum { DIMENSIONS = 12, PEOPLE = 8, TEMPLATES = 3 };

/* cmocka set-up and tear-down of a test: *state becomes the metric. */
int site_rig_set_up(void **state);
int site_rig_tear_down(void **state);

/* Returns the vector of template i of a person, by the metric. */
struct iso_metric_vector site_rig_vector_of(const struct iso_metric *metric, int64_t person, int i);

/* Returns the number of template i of a person. */
uint64_t site_rig_number_of(int64_t person, int i);

/* Makes an index of nobody and starts it. */
struct iso_site_index *site_rig_new_index(const struct iso_metric *metric, bool adapt);

/* Adds template i of a person to the index, as if it was made before this sensor, or before
 * SITE_RIG_SENSOR. */
#define SITE_RIG_SENSOR "astra"
void site_rig_add_template_of(struct iso_site_index *site, const struct iso_metric *metric,
                              int64_t person, int i, const char *sensor);
void site_rig_add_template(struct iso_site_index *site, const struct iso_metric *metric,
                           int64_t person, int i);

/* Adds the templates 0 to TEMPLATES - 1 of a person to the index. */
void site_rig_add_person(struct iso_site_index *site, const struct iso_metric *metric,
                         int64_t person);

#endif
