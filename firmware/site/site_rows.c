#include "firmware/site/site_rows.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"

static int8_t *mean_at(const struct iso_site_rows *rows, size_t at)
{
    return &rows->mean[at * rows->width];
}

int iso_site_rows_reserve(struct iso_site_rows *rows, size_t n)
{
    if (rows->n + n <= rows->capacity) {
        return 0;
    }
    const size_t doubled = rows->capacity ? 2 * rows->capacity : 16;
    const size_t capacity = rows->n + n > doubled ? rows->n + n : doubled;
    int64_t *person = iso_wipe_grow(rows->person, rows->n, capacity, sizeof *person);
    if (!person) {
        return -ENOMEM;
    }
    rows->person = person;
    uint64_t *number = iso_wipe_grow(rows->number, rows->n, capacity, sizeof *number);
    if (!number) {
        return -ENOMEM;
    }
    rows->number = number;
    char(*sensor)[ISO_TEMPLATE_SENSOR_MAX] = iso_wipe_grow(rows->sensor, rows->n, capacity,
                                                           sizeof *sensor);
    if (!sensor) {
        return -ENOMEM;
    }
    rows->sensor = sensor;
    float *unit = iso_wipe_grow(rows->unit, rows->n, capacity, sizeof *unit);
    if (!unit) {
        return -ENOMEM;
    }
    rows->unit = unit;
    int8_t *mean = iso_wipe_grow(rows->mean, rows->n, capacity, rows->width * sizeof *mean);
    if (!mean) {
        return -ENOMEM;
    }
    rows->mean = mean;
    rows->capacity = capacity;
    return 0;
}

/* The first row whose person has at least this number. */
static size_t lower_bound(const struct iso_site_rows *rows, int64_t person)
{
    size_t low = 0, high = rows->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (rows->person[middle] < person) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* The row behind those of a person. */
static size_t end_of(const struct iso_site_rows *rows, int64_t person)
{
    size_t at = lower_bound(rows, person);
    while (at < rows->n && rows->person[at] == person) {
        at++;
    }
    return at;
}

size_t iso_site_rows_find(const struct iso_site_rows *rows, int64_t person)
{
    return lower_bound(rows, person);
}

/* Moves all rows from `from` to the end, so that they begin at `to`. */
static void move_rows(struct iso_site_rows *rows, size_t from, size_t to)
{
    const size_t n = rows->n - from;
    memmove(&rows->person[to], &rows->person[from], n * sizeof *rows->person);
    memmove(&rows->number[to], &rows->number[from], n * sizeof *rows->number);
    memmove(&rows->sensor[to], &rows->sensor[from], n * sizeof *rows->sensor);
    memmove(&rows->unit[to], &rows->unit[from], n * sizeof *rows->unit);
    memmove(mean_at(rows, to), mean_at(rows, from), n * rows->width * sizeof *rows->mean);
}

/* The smallest power of two of which 127 reach the largest number; 1 for zeros alone, NaN for a
 * number that is not finite. */
static float unit_of(const float *mean, size_t n)
{
    float largest = 0.0f;
    int exponent;
    for (size_t d = 0; d < n; d++) {
        if (!isfinite(mean[d])) {
            return NAN;
        }
        largest = fmaxf(largest, fabsf(mean[d]));
    }
    const float fraction = frexpf(largest / 127.0f, &exponent);
    return fraction > 0.0f ? ldexpf(1.0f, fraction > 0.5f ? exponent : exponent - 1) : 1.0f;
}

static void set_row(struct iso_site_rows *rows, size_t at, const float *mean)
{
    const float unit = unit_of(mean, rows->width);
    int8_t *row = mean_at(rows, at);
    rows->unit[at] = unit;
    for (size_t d = 0; d < rows->width; d++) {
        row[d] = isnan(unit) ? 0 : (int8_t)lrintf(mean[d] / unit);
    }
}

void iso_site_rows_insert(struct iso_site_rows *rows, int64_t person, uint64_t number,
                          const char *sensor, const struct iso_metric_vector *vector)
{
    const size_t at = end_of(rows, person);
    move_rows(rows, at, at + 1);
    rows->n++;
    rows->person[at] = person;
    rows->number[at] = number;
    (void)snprintf(rows->sensor[at], sizeof *rows->sensor, "%s", sensor);
    set_row(rows, at, vector->mean);
}

void iso_site_rows_remove(struct iso_site_rows *rows, int64_t person)
{
    const size_t first = lower_bound(rows, person), end = end_of(rows, person);
    const size_t gone = end - first;
    if (gone > 0) {
        move_rows(rows, end, first);
        rows->n -= gone;
        explicit_bzero(&rows->person[rows->n], gone * sizeof *rows->person);
        explicit_bzero(&rows->number[rows->n], gone * sizeof *rows->number);
        explicit_bzero(&rows->sensor[rows->n], gone * sizeof *rows->sensor);
        explicit_bzero(&rows->unit[rows->n], gone * sizeof *rows->unit);
        explicit_bzero(mean_at(rows, rows->n), gone * rows->width * sizeof *rows->mean);
    }
}

void iso_site_rows_get(const struct iso_site_rows *rows, size_t at, struct iso_metric_vector *out)
{
    const int8_t *row = mean_at(rows, at);
    *out = (struct iso_metric_vector){.n = 1};
    for (size_t d = 0; d < rows->width; d++) {
        out->mean[d] = rows->unit[at] * (float)row[d];
    }
}

static bool is_of_class(const struct iso_site_rows *rows, const struct iso_site_teaching *teaching,
                        size_t at)
{
    return !*teaching->sensor || strcmp(rows->sensor[at], teaching->sensor) == 0;
}

int iso_site_rows_copy(const struct iso_site_rows *rows, const struct iso_site_teaching *teaching,
                       size_t first, struct iso_metric_vector *out, int capacity, size_t *next)
{
    int n = 0;
    size_t at = first;
    for (; at < rows->n && rows->person[at] == rows->person[first]; at++) {
        if (n < capacity &&
            (!teaching || (is_of_class(rows, teaching, at) &&
                           iso_site_record_teaches(&teaching->record, rows->number[at])))) {
            iso_site_rows_get(rows, at, &out[n++]);
        }
    }
    *next = at;
    return n;
}

bool iso_site_rows_are_same(const struct iso_site_rows *rows, const struct iso_site_teaching *one,
                            const struct iso_site_teaching *other)
{
    size_t at = 0;
    while (at < rows->n && is_of_class(rows, one, at) == is_of_class(rows, other, at)) {
        at++;
    }
    return at == rows->n;
}

bool iso_site_rows_is_other(const struct iso_site_rows *rows,
                            const struct iso_site_teaching *teaching, int64_t person)
{
    size_t at = lower_bound(rows, person);
    const size_t end = end_of(rows, person);
    const bool has_rows = at < end;
    while (at < end && !is_of_class(rows, teaching, at)) {
        at++;
    }
    return has_rows && at == end;
}

void iso_site_rows_free(struct iso_site_rows *rows)
{
    iso_wipe_free(rows->person);
    iso_wipe_free(rows->number);
    iso_wipe_free(rows->sensor);
    iso_wipe_free(rows->unit);
    iso_wipe_free(rows->mean);
    *rows = (struct iso_site_rows){.width = rows->width};
}
