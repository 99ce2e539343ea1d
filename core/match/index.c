#include "isotherm/index.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lanes.h"

enum { STRIDE_MAX = (ISO_METRIC_DIMENSIONS_MAX + ISO_LANES - 1) / ISO_LANES * ISO_LANES };

struct row {
    int64_t person;
    float scale, weight; /* of the vector */
    int32_t n;           /* templates */
    int32_t step;
};

/* The coefficients of the score of one probe, for people of one step. A person with the numbers y,
 * not yet scaled, has the score constant + scale * sum weight y + scale^2 * sum square y^2. */
struct view {
    double constant;
    float weight[STRIDE_MAX], square[STRIDE_MAX];
};

struct iso_index {
    const struct iso_metric *metric;
    size_t stride; /* floats of a vector: the dimensions, filled up to a multiple of ISO_LANES */
    size_t n, capacity;
    struct row *row;                 /* by rising person */
    float *mean;                     /* [capacity][stride] */
    size_t people[ISO_METRIC_STEPS]; /* how many people have vectors of each step */
    struct view *views;              /* [ISO_METRIC_STEPS] working memory of a search */
};

/* ---- memory ---- */

int iso_index_new(const struct iso_metric *metric, struct iso_index **out)
{
    struct iso_index *index = calloc(1, sizeof *index);
    if (!index) {
        return -ENOMEM;
    }
    index->views = calloc(ISO_METRIC_STEPS, sizeof *index->views);
    if (!index->views) {
        free(index);
        return -ENOMEM;
    }
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
        free(index->views);
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
    struct row *row = calloc(capacity, sizeof *row);
    float *mean = calloc(capacity, index->stride * sizeof *mean);
    if (!row || !mean) {
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

/* ---- the closed form ---- */

static void make_view(const struct iso_metric *metric, const struct iso_metric_vector *probe,
                      int step, struct view *view)
{
    const double v = iso_metric_variance(probe->step), w = iso_metric_variance(step);
    const double half = 0.5 * (double)metric->gain;
    double sum = 0.0;
    memset(view->weight, 0, sizeof view->weight);
    memset(view->square, 0, sizeof view->square);
    for (int d = 0; d < metric->n_dimensions; d++) {
        const double b = (double)metric->between[d], x = (double)(probe->scale * probe->mean[d]);
        const double shrink = b / (b + w), same = v + b * w / (b + w), any = v + b;
        sum += x * x * (1.0 / any - 1.0 / same) + log(any / same);
        view->weight[d] = (float)(half * x * 2.0 * shrink / same);
        view->square[d] = (float)(-half * shrink * shrink / same);
    }
    view->constant = half * sum + (double)metric->bias;
}

/* The sum of the lanes. They are passed by address, because the way in which a vector is passed by
 * value depends on the processor that the compiler compiles for. */
static float sum_of(const iso_lanes *lanes)
{
    float a[ISO_LANES];
    memcpy(a, lanes, sizeof a);
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

/* The score of a person's numbers for a view. */
static double score_of(const struct view *view, const float *mean, float scale, size_t stride)
{
    iso_lanes linear = {0}, square = {0};
    for (size_t i = 0; i < stride; i += ISO_LANES) {
        const iso_lanes y = ISO_LANES_LOAD(&mean[i]);
        linear += ISO_LANES_LOAD(&view->weight[i]) * y;
        square += ISO_LANES_LOAD(&view->square[i]) * y * y;
    }
    return view->constant +
           (double)scale * ((double)sum_of(&linear) + (double)scale * (double)sum_of(&square));
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

static float *mean_at(const struct iso_index *index, size_t at)
{
    return &index->mean[at * index->stride];
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
    memmove(mean_at(index, to), mean_at(index, from), n * index->stride * sizeof *index->mean);
}

int iso_index_put(struct iso_index *index, int64_t person, const struct iso_metric_vector *vector)
{
    const size_t at = lower_bound(index, person);
    if (vector->n < 1 || vector->n > ISO_INDEX_TEMPLATES_MAX ||
        vector->step < ISO_METRIC_STEP_MIN || vector->step > ISO_METRIC_STEP_MAX) {
        return -EINVAL;
    }
    if (is_at(index, person, at)) {
        (*people_at(index, index->row[at].step))--;
    } else if (index->n == index->capacity) {
        return -ENOSPC;
    } else {
        move_rows(index, at, at + 1);
        index->n++;
    }
    index->row[at] = (struct row){
        .person = person,
        .scale = vector->scale,
        .weight = vector->weight,
        .n = vector->n,
        .step = vector->step,
    };
    float *mean = mean_at(index, at);
    memset(mean, 0, index->stride * sizeof *mean);
    memcpy(mean, vector->mean, (size_t)index->metric->n_dimensions * sizeof *mean);
    (*people_at(index, vector->step))++;
    return 0;
}

static void vector_at(const struct iso_index *index, size_t at, struct iso_metric_vector *out)
{
    out->n = index->row[at].n;
    out->weight = index->row[at].weight;
    out->step = index->row[at].step;
    out->scale = index->row[at].scale;
    memset(out->mean, 0, sizeof out->mean);
    memcpy(out->mean, mean_at(index, at), (size_t)index->metric->n_dimensions * sizeof *out->mean);
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
    vector_at(index, at, out);
    return 0;
}

int iso_index_remove(struct iso_index *index, int64_t person)
{
    const size_t at = lower_bound(index, person);
    if (!is_at(index, person, at)) {
        return -ENOENT;
    }
    (*people_at(index, index->row[at].step))--;
    move_rows(index, at + 1, at);
    index->n--;
    explicit_bzero(&index->row[index->n], sizeof *index->row);
    explicit_bzero(mean_at(index, index->n), index->stride * sizeof *index->mean);
    return 0;
}

/* ---- searching ---- */

/* A row and its score in the scan. */
struct candidate {
    size_t at;
    double score;
};

/* Inserts a candidate into a list of n that is sorted by falling score. Of equal scores the earlier
 * row stays first. Returns the new length, at most `capacity`. */
static int keep_candidate(struct candidate *best, int n, int capacity, struct candidate candidate)
{
    int i = n < capacity ? n : capacity - 1;
    for (; i > 0 && best[i - 1].score < candidate.score; i--) {
        best[i] = best[i - 1];
    }
    best[i] = candidate;
    return n < capacity ? n + 1 : n;
}

static int scan_people(const struct iso_index *index, const struct view *views,
                       struct candidate *best, int capacity)
{
    double worst = -INFINITY; /* of a full list */
    int n = 0;
    for (size_t i = 0; i < index->n; i++) {
        const struct row *row = &index->row[i];
        const struct view *view = &views[row->step - ISO_METRIC_STEP_MIN];
        const double score = score_of(view, mean_at(index, i), row->scale, index->stride);
        if (n < capacity || score > worst) {
            n = keep_candidate(best, n, capacity, (struct candidate){i, score});
            worst = best[n - 1].score;
        }
    }
    return n;
}

static bool comes_before(const struct iso_search_hit *a, const struct iso_search_hit *b)
{
    return a->score > b->score || (a->score >= b->score && a->person < b->person);
}

int iso_index_search(const struct iso_index *index, const struct iso_metric_vector *probe,
                     struct iso_search_hit *hits, int capacity, int *n_hits)
{
    struct view *const views = index->views;
    struct candidate best[ISO_INDEX_HITS_MAX];
    struct iso_metric_vector person;
    if (probe->n != 1 || capacity < 0 || capacity > ISO_INDEX_HITS_MAX) {
        return -EINVAL;
    }
    for (int k = 0; k < ISO_METRIC_STEPS; k++) {
        if (index->people[k] > 0) {
            make_view(index->metric, probe, k + ISO_METRIC_STEP_MIN, &views[k]);
        }
    }
    const int n = capacity > 0 ? scan_people(index, views, best, capacity) : 0;
    for (int i = 0; i < n; i++) {
        vector_at(index, best[i].at, &person);
        const struct iso_search_hit hit = {
            .person = index->row[best[i].at].person,
            .distance_mm = NAN,
            .score = iso_metric_score(index->metric, &person, probe),
        };
        int at = i;
        for (; at > 0 && comes_before(&hit, &hits[at - 1]); at--) {
            hits[at] = hits[at - 1];
        }
        hits[at] = hit;
    }
    explicit_bzero(views, ISO_METRIC_STEPS * sizeof *views);
    explicit_bzero(&person, sizeof person);
    *n_hits = n;
    return 0;
}
