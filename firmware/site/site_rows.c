#include "firmware/site/site_rows.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"

static float *mean_at(const struct iso_site_rows *rows, size_t at)
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
    float *mean = iso_wipe_grow(rows->mean, rows->n, capacity, rows->width * sizeof *mean);
    if (!mean) {
        return -ENOMEM;
    }
    rows->mean = mean;
    rows->capacity = capacity;
    return 0;
}

/* The first row of a person with a number above this one. */
static size_t first_behind(const struct iso_site_rows *rows, int64_t person)
{
    size_t low = 0, high = rows->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (rows->person[middle] <= person) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Moves all rows from `from` to the end, so that they begin at `to`. */
static void move_rows(struct iso_site_rows *rows, size_t from, size_t to)
{
    const size_t n = rows->n - from;
    memmove(&rows->person[to], &rows->person[from], n * sizeof *rows->person);
    memmove(&rows->number[to], &rows->number[from], n * sizeof *rows->number);
    memmove(mean_at(rows, to), mean_at(rows, from), n * rows->width * sizeof *rows->mean);
}

void iso_site_rows_insert(struct iso_site_rows *rows, int64_t person, uint64_t number,
                          const struct iso_metric_vector *vector)
{
    const size_t at = first_behind(rows, person);
    move_rows(rows, at, at + 1);
    rows->n++;
    rows->person[at] = person;
    rows->number[at] = number;
    memcpy(mean_at(rows, at), vector->mean, rows->width * sizeof *rows->mean);
}

void iso_site_rows_remove(struct iso_site_rows *rows, int64_t person)
{
    const size_t end = first_behind(rows, person);
    size_t first = end;
    while (first > 0 && rows->person[first - 1] == person) {
        first--;
    }
    const size_t gone = end - first;
    if (gone > 0) {
        move_rows(rows, end, first);
        rows->n -= gone;
        explicit_bzero(&rows->person[rows->n], gone * sizeof *rows->person);
        explicit_bzero(&rows->number[rows->n], gone * sizeof *rows->number);
        explicit_bzero(mean_at(rows, rows->n), gone * rows->width * sizeof *rows->mean);
    }
}

int iso_site_rows_copy(const struct iso_site_rows *rows, const struct iso_site_record *teaching,
                       size_t first, struct iso_metric_vector *out, int capacity, size_t *next)
{
    int n = 0;
    size_t at = first;
    for (; at < rows->n && rows->person[at] == rows->person[first]; at++) {
        if (n < capacity && (!teaching || iso_site_record_teaches(teaching, rows->number[at]))) {
            out[n] = (struct iso_metric_vector){.n = 1};
            memcpy(out[n++].mean, mean_at(rows, at), rows->width * sizeof *rows->mean);
        }
    }
    *next = at;
    return n;
}

void iso_site_rows_free(struct iso_site_rows *rows)
{
    iso_wipe_free(rows->person);
    iso_wipe_free(rows->number);
    iso_wipe_free(rows->mean);
    *rows = (struct iso_site_rows){.width = rows->width};
}
