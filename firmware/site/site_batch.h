/* Adds many templates to the index of a site, when a gallery is loaded. ISO_METRIC_ROWS templates
 * are projected at once, because the projection is larger than a cache
 * (core/match/metric_vector.h). The index is the same, to the bit, as after as many calls of
 * iso_metric_project() and iso_site_index_add(). Biometric data: wiped when the batch is freed. */
#ifndef ISO_FIRMWARE_SITE_SITE_BATCH_H
#define ISO_FIRMWARE_SITE_SITE_BATCH_H

#include <stdbool.h>

#include "firmware/site/site_index.h"

struct iso_site_batch;

/* Makes a batch for templates of one algorithm. The index and the metric outlive it. -ENOMEM. */
int iso_site_batch_new(struct iso_site_index *site, uint32_t algorithm,
                       const struct iso_metric *metric, struct iso_site_batch **out)
    __attribute__((warn_unused_result));

/* Wipes and frees it. What was not added yet is lost. NULL is accepted. */
void iso_site_batch_free(struct iso_site_batch *batch);

/* Adds a serialised template of a person to the index, at once or in a later call; its `number` is
 * that of site_index.h. A template that has too few points for a vector adds nothing. Errors of
 * iso_template_parse(); -EINVAL of another algorithm or not fit for the metric; and -ENOMEM and
 * errors of iso_site_index_add(), also those of earlier templates. */
int iso_site_batch_add(struct iso_site_batch *batch, int64_t person, int64_t number,
                       const void *bytes, size_t size) __attribute__((warn_unused_result));

/* Adds a vector that an earlier batch has made of a template, behind the templates that wait.
 * -ENOMEM, and errors of iso_site_index_add(), also those of earlier templates. */
int iso_site_batch_add_vector(struct iso_site_batch *batch, int64_t person, int64_t number,
                              const char *sensor, const struct iso_metric_vector *vector)
    __attribute__((warn_unused_result));

/* Receives a vector that a batch has made of template `number`, which was learned or not. sensor:
 * [ISO_TEMPLATE_SENSOR_MAX]. Both are valid during the call. */
typedef void iso_site_batch_made(void *context, int64_t number, bool learned, const char *sensor,
                                 const struct iso_metric_vector *vector);

/* Calls `made` from now on for each vector that is made and added. */
void iso_site_batch_tell(struct iso_site_batch *batch, iso_site_batch_made *made, void *context);

/* Whether a template of iso_site_batch_add() was learned at a visit. iso_site_batch_add_vector() is
 * not told. */
bool iso_site_batch_learned(const struct iso_site_batch *batch);

/* Adds the templates that wait. -ENOMEM, and errors of iso_site_index_add(). */
int iso_site_batch_end(struct iso_site_batch *batch) __attribute__((warn_unused_result));

#endif
