/* The vectors of all templates by the shipped metric: one row for each template, sorted by person.
 *
 * A number of a vector takes one byte: it is rounded to a multiple of the row's unit, which is the
 * smallest power of two with which the largest number fits. Vectors of real people reach about 12
 * standard deviations within a person, so that the error of rounding has a standard deviation of
 * 0.04. A vector that is rounded once more stays the same.
 *
 * Two threads must not change it at the same time. Biometric data. */
#ifndef ISO_FIRMWARE_SITE_SITE_ROWS_H
#define ISO_FIRMWARE_SITE_SITE_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/site/site_record.h"
#include "isotherm/metric.h"
#include "isotherm/template.h"

/* Which rows teach the metric. A row teaches if the record does not exclude its template, and if a
 * sensor of this class made the template. The class is the text that a template stores: the first
 * ISO_TEMPLATE_SENSOR_MAX - 1 bytes of the model that the driver reports. Two cameras of one model
 * are of one class. All zero: all rows teach. */
struct iso_site_teaching {
    struct iso_site_record record;
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* "": not known, and templates of every class teach */
};

/* All zero but for `width`: no rows. */
struct iso_site_rows {
    size_t width;                            /* numbers of a vector */
    size_t n;                                /* rows in use */
    size_t capacity;                         /* rows that there is room for */
    int64_t *person;                         /* [capacity], rising */
    uint64_t *number;                        /* [capacity]: of the template (site_record.h) */
    char (*sensor)[ISO_TEMPLATE_SENSOR_MAX]; /* [capacity]: the class of sensor of the template */
    float *unit;                             /* [capacity] */
    int8_t *mean;                            /* [capacity][width]: in units, -127..127 */
};

/* Makes room for n more rows. -ENOMEM. */
int iso_site_rows_reserve(struct iso_site_rows *rows, size_t n) __attribute__((warn_unused_result));

/* Inserts a row behind the last one of its person. The caller has made room. If a number of the
 * vector is not finite, the row gives a vector of NaN. Of the sensor, the first
 * ISO_TEMPLATE_SENSOR_MAX - 1 bytes count. */
void iso_site_rows_insert(struct iso_site_rows *rows, int64_t person, uint64_t number,
                          const char *sensor, const struct iso_metric_vector *vector);

/* Removes and wipes the rows of a person. */
void iso_site_rows_remove(struct iso_site_rows *rows, int64_t person);

/* The first row of a person; rows->n or a row of somebody else if there is none. */
size_t iso_site_rows_find(const struct iso_site_rows *rows, int64_t person);

/* Copies a row. Sets only n and mean of the vector. */
void iso_site_rows_get(const struct iso_site_rows *rows, size_t at, struct iso_metric_vector *out);

/* Copies the rows of one person to `out`, at most `capacity` of them: all, or with `teaching`
 * only those that teach. `first`, less than rows->n, is the person's first row. Sets only n and
 * mean of each vector. Returns the number of vectors; *next receives the first row of the next
 * person. */
int iso_site_rows_copy(const struct iso_site_rows *rows, const struct iso_site_teaching *teaching,
                       size_t first, struct iso_metric_vector *out, int capacity, size_t *next);

/* Whether the same rows are of the class of both. The records do not matter. */
bool iso_site_rows_are_same(const struct iso_site_rows *rows, const struct iso_site_teaching *one,
                            const struct iso_site_teaching *other);

/* Whether a person has rows, but none of the class of sensor that teaches. False while that class
 * is not known. */
bool iso_site_rows_is_other(const struct iso_site_rows *rows,
                            const struct iso_site_teaching *teaching, int64_t person);

/* Wipes and frees all rows. */
void iso_site_rows_free(struct iso_site_rows *rows);

#endif
