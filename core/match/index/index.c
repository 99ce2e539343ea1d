#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/match/index/index_inside.h"

/* ---- memory ---- */

int iso_index_new(const struct iso_metric *metric, struct iso_index **out)
{
    struct iso_index *index = calloc(1, sizeof *index);
    if (!index) {
        return -ENOMEM;
    }
    index->terms = calloc(ISO_METRIC_STEPS, sizeof *index->terms);
    index->bounds = calloc(ISO_METRIC_STEPS, sizeof *index->bounds);
    if (!index->terms || !index->bounds) {
        free(index->terms);
        free(index->bounds);
        free(index);
        return -ENOMEM;
    }
    iso_codes_init(&index->codes, metric);
    index->filter = iso_code_filter_here();
    index->metric = metric;
    index->stride = ((size_t)metric->n_dimensions + ISO_LANES - 1) / ISO_LANES * ISO_LANES;
    *out = index;
    return 0;
}

/* Wipes and frees the rows. Only the rows in use need it: the others were never written, or were
 * wiped before. */
static void wipe_rows(struct iso_index *index)
{
    if (index->n > 0) {
        explicit_bzero(index->row, index->n * sizeof *index->row);
        explicit_bzero(index->mean, index->n * index->stride * sizeof *index->mean);
    }
    free(index->row);
    free(index->mean);
}

void iso_index_free(struct iso_index *index)
{
    if (index) {
        wipe_rows(index);
        iso_codes_done(&index->codes);
        free(index->terms);
        free(index->bounds);
        free(index);
    }
}

int iso_index_reserve(struct iso_index *index, size_t n_people)
{
    if (n_people <= index->capacity) {
        return 0;
    }
    const size_t least = index->capacity ? 2 * index->capacity : 16;
    const size_t capacity = n_people > least ? n_people : least;
    /* Not realloc, which would leave a copy in the old memory. */
    struct iso_index_row *row = calloc(capacity, sizeof *row);
    float *mean = calloc(capacity, index->stride * sizeof *mean);
    if (!row || !mean || iso_codes_reserve(&index->codes, capacity)) {
        free(row);
        free(mean);
        return -ENOMEM;
    }
    if (index->n > 0) {
        memcpy(row, index->row, index->n * sizeof *row);
        memcpy(mean, index->mean, index->n * index->stride * sizeof *mean);
    }
    wipe_rows(index);
    index->row = row;
    index->mean = mean;
    index->capacity = capacity;
    return 0;
}

size_t iso_index_size(const struct iso_index *index)
{
    return index->n;
}

/* ---- rows ---- */

/* The first row of this person or one with a larger number. */
static size_t lower_bound(const struct iso_index *index, int64_t person)
{
    size_t low = 0, high = index->n;
    if (high > 0 && index->row[high - 1].person < person) {
        return high; /* the usual case: a gallery adds people in this order */
    }
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (index->row[middle].person < person) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static bool is_at(const struct iso_index *index, int64_t person, size_t at)
{
    return at < index->n && index->row[at].person == person;
}

static size_t *people_at(struct iso_index *index, int step)
{
    return &index->people[step - ISO_METRIC_STEP_MIN];
}

/* Moves all rows from index `from` to the end, so that they begin at index `to`. */
static void move_rows(struct iso_index *index, size_t from, size_t to)
{
    const size_t n = index->n - from;
    memmove(&index->row[to], &index->row[from], n * sizeof *index->row);
    memmove(iso__index_mean(index, to), iso__index_mean(index, from),
            n * index->stride * sizeof *index->mean);
    for (size_t i = to; i < to + n; i++) {
        iso_codes_set_row(&index->codes, index->row[i].place, (uint32_t)i);
    }
}

/* The codes of a row have moved. */
static void note_place(void *context, uint32_t row, uint32_t place)
{
    struct iso_index *index = context;
    index->row[row].place = place;
}

/* Forgets the codes of a row, and that its person has this step. */
static void forget_codes(struct iso_index *index, size_t at)
{
    (*people_at(index, index->row[at].step))--;
    iso_codes_remove(&index->codes, index->row[at].place, note_place, index);
}

int iso_index_put(struct iso_index *index, int64_t person, const struct iso_metric_vector *vector)
{
    const size_t at = lower_bound(index, person);
    if (vector->n < 1 || vector->n > ISO_INDEX_TEMPLATES_MAX ||
        vector->step < ISO_METRIC_STEP_MIN || vector->step > ISO_METRIC_STEP_MAX) {
        return -EINVAL;
    }
    if (is_at(index, person, at)) {
        forget_codes(index, at);
    } else if (index->n == index->capacity) {
        return -ENOSPC;
    } else {
        move_rows(index, at, at + 1);
        index->n++;
    }
    index->row[at] = (struct iso_index_row){
        .person = person,
        .scale = vector->scale,
        .weight = vector->weight,
        .place = iso_codes_put(&index->codes, (uint32_t)at, vector),
        .step = (int8_t)vector->step,
        .n = (uint8_t)vector->n,
    };
    float *mean = iso__index_mean(index, at);
    memset(mean, 0, index->stride * sizeof *mean);
    memcpy(mean, vector->mean, (size_t)index->metric->n_dimensions * sizeof *mean);
    (*people_at(index, vector->step))++;
    return 0;
}

void iso__index_vector(const struct iso_index *index, size_t at, struct iso_metric_vector *out)
{
    out->n = index->row[at].n;
    out->weight = index->row[at].weight;
    out->step = index->row[at].step;
    out->scale = index->row[at].scale;
    memset(out->mean, 0, sizeof out->mean);
    memcpy(out->mean, iso__index_mean(index, at),
           (size_t)index->metric->n_dimensions * sizeof *out->mean);
}

int iso_index_add(struct iso_index *index, int64_t person, const struct iso_metric_vector *one)
{
    struct iso_metric_vector all = {.n = 0};
    if (one->n < 1) {
        return -EINVAL;
    }
    (void)!iso_index_find(index, person, &all);
    iso_metric_vector_add(index->metric, one, &all);
    const int error = iso_index_put(index, person, &all);
    explicit_bzero(&all, sizeof all);
    return error;
}

int iso_index_find(const struct iso_index *index, int64_t person, struct iso_metric_vector *out)
{
    const size_t at = lower_bound(index, person);
    if (!is_at(index, person, at)) {
        return -ENOENT;
    }
    iso__index_vector(index, at, out);
    return 0;
}

int iso_index_remove(struct iso_index *index, int64_t person)
{
    const size_t at = lower_bound(index, person);
    if (!is_at(index, person, at)) {
        return -ENOENT;
    }
    forget_codes(index, at);
    move_rows(index, at + 1, at);
    index->n--;
    explicit_bzero(&index->row[index->n], sizeof *index->row);
    explicit_bzero(iso__index_mean(index, index->n), index->stride * sizeof *index->mean);
    return 0;
}
