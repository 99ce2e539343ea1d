/* The search of an index: the closed form of the score, and which people are scored. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/match/index/index_inside.h"

/* Fewer people are scored without bounds: in an index, and of one step. */
enum { PEOPLE_FOR_CODES = 512, PEOPLE_FOR_BOUNDS = 96, SAMPLE = 64 };

/* The most people who wait for their vectors, and the bytes that the processor fetches at once. */
enum { WAITING = 8, CACHE_LINE = 64 };

/* ---- the closed form ---- */

static void make_terms(const struct iso_metric *metric, const struct iso_metric_vector *probe,
                       int step, struct iso_score_terms *terms)
{
    const double v = iso_metric_variance(probe->step), w = iso_metric_variance(step);
    const double half = 0.5 * (double)metric->gain;
    double sum = 0.0;
    memset(terms->weight, 0, sizeof terms->weight);
    memset(terms->square, 0, sizeof terms->square);
    for (int d = 0; d < metric->n_dimensions; d++) {
        const double b = (double)metric->between[d], x = (double)(probe->scale * probe->mean[d]);
        const double shrink = b / (b + w), same = v + b * w / (b + w), any = v + b;
        sum += x * x * (1.0 / any - 1.0 / same) + log(any / same);
        terms->weight[d] = (float)(half * x * 2.0 * shrink / same);
        terms->square[d] = (float)(-half * shrink * shrink / same);
    }
    terms->constant = half * sum + (double)metric->bias;
}

/* The sum of the lanes. They are passed by address, because the way in which a vector is passed by
 * value depends on the processor that the compiler compiles for. */
static float sum_of(const iso_lanes *lanes)
{
    float a[ISO_LANES];
    memcpy(a, lanes, sizeof a);
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

/* The score of a person's numbers by these terms. */
static double score_of(const struct iso_score_terms *terms, const float *mean, float scale,
                       size_t stride)
{
    iso_lanes linear = {0}, square = {0};
    for (size_t i = 0; i < stride; i += ISO_LANES) {
        const iso_lanes y = ISO_LANES_LOAD(&mean[i]);
        linear += ISO_LANES_LOAD(&terms->weight[i]) * y;
        square += ISO_LANES_LOAD(&terms->square[i]) * y * y;
    }
    return terms->constant +
           (double)scale * ((double)sum_of(&linear) + (double)scale * (double)sum_of(&square));
}

/* ---- searching ---- */

/* A row and its score in the scan. */
struct candidate {
    size_t at;
    double score;
};

/* The best candidates so far, by falling score. Of equal scores the earlier row is first. */
struct best {
    int n, capacity;
    double least; /* nobody with a lower score is among the best */
    struct candidate *candidate;
};

static bool ranks_before(const struct candidate *a, const struct candidate *b)
{
    return a->score > b->score || (a->score >= b->score && a->at < b->at);
}

static void keep_candidate(struct best *best, struct candidate new)
{
    struct candidate *list = best->candidate;
    int i = best->n;
    if (best->n < best->capacity) {
        best->n++;
    } else if (ranks_before(&new, &list[best->n - 1])) {
        i--;
    } else {
        return;
    }
    for (; i > 0 && ranks_before(&new, &list[i - 1]); i--) {
        list[i] = list[i - 1];
    }
    list[i] = new;
    if (best->n == best->capacity) {
        best->least = fmax(best->least, list[best->n - 1].score);
    }
}

static double score_at(const struct iso_index *index, size_t at)
{
    const struct iso_index_row *row = &index->row[at];
    const struct iso_score_terms *terms = &index->terms[row->step - ISO_METRIC_STEP_MIN];
    return score_of(terms, iso__index_mean(index, at), row->scale, index->stride);
}

static void scan_everybody(const struct iso_index *index, struct best *best)
{
    for (size_t i = 0; i < index->n; i++) {
        keep_candidate(best, (struct candidate){i, score_at(index, i)});
    }
}

/* A score that `capacity` people reach: that of the last of the best of a sample. */
static double least_of_sample(const struct iso_index *index, int capacity)
{
    struct candidate list[ISO_INDEX_HITS_MAX];
    struct best best = {.capacity = capacity, .least = -INFINITY, .candidate = list};
    for (size_t i = 0; i < SAMPLE; i++) {
        const size_t at = i * index->n / SAMPLE;
        keep_candidate(&best, (struct candidate){at, score_at(index, at)});
    }
    return best.least;
}

/* Rows that will be scored. Their memory is fetched while the codes of the next blocks are
 * compared: rows and vectors of a large index are in no cache, and each would have to be waited
 * for. Until a row is scored it cannot raise the least score, so a few people more are scored, but
 * the best are the same. */
struct waiting {
    size_t n; /* so far */
    size_t at[WAITING];
};

static void score_waiting(const struct iso_index *index, const struct waiting *waiting, size_t i,
                          struct best *best)
{
    const size_t at = waiting->at[i % WAITING];
    keep_candidate(best, (struct candidate){at, score_at(index, at)});
}

static void score_all_waiting(const struct iso_index *index, const struct waiting *waiting,
                              struct best *best)
{
    for (size_t i = waiting->n < WAITING ? 0 : waiting->n - WAITING; i < waiting->n; i++) {
        score_waiting(index, waiting, i, best);
    }
}

/* The people of a block whose bits are set begin to wait. If too many wait, the first of these are
 * scored. The fetches are not in a function of their own: gcc 12 removes calls of a function that
 * only fetches. */
static void wait_for_block(const struct iso_index *index, const struct iso_code_block *block,
                           uint32_t bits, struct waiting *waiting, struct best *best)
{
    for (; bits != 0; bits &= bits - 1) {
        const size_t at = block->row[__builtin_ctz(bits)];
        if (waiting->n >= WAITING) {
            score_waiting(index, waiting, waiting->n - WAITING, best);
        }
        waiting->at[waiting->n++ % WAITING] = at;
        __builtin_prefetch(&index->row[at]);
        const float *mean = iso__index_mean(index, at);
        for (size_t i = 0; i < index->stride; i += CACHE_LINE / sizeof *mean) {
            __builtin_prefetch(&mean[i]);
        }
        __builtin_prefetch(&mean[index->stride - 1]); /* no row begins with a line of the cache */
    }
}

/* The people of a block who may be among the best: a bit each. */
static uint32_t bits_of(const struct iso_index *index, const struct iso_code_block *block,
                        double least)
{
    const uint32_t everybody = (uint32_t)((UINT64_C(1) << block->n) - 1);
    const struct iso_code_bounds *bounds = &index->bounds[block->step];
    if (index->people[block->step] < PEOPLE_FOR_BOUNDS) {
        return everybody;
    }
    const int32_t limit = iso_code_limit(bounds, least);
    if (limit < 0) {
        return 0;
    }
    return everybody & index->filter(block->code, &bounds->probe, index->codes.n_pairs, limit);
}

static void scan_by_codes(const struct iso_index *index, struct best *best)
{
    const struct iso_codes *codes = &index->codes;
    const struct iso_code_block *before = NULL;
    uint32_t bits_before = 0;
    struct waiting waiting = {.n = 0};
    best->least = least_of_sample(index, best->capacity);
    for (int step = 0; step < ISO_METRIC_STEPS; step++) {
        if (index->people[step] >= PEOPLE_FOR_BOUNDS) {
            iso_codes_bound(codes, &index->terms[step], &index->bounds[step]);
        }
    }
    for (size_t b = 0; b < codes->n_blocks; b++) {
        const struct iso_code_block *block = &codes->block[b];
        const uint32_t bits = bits_of(index, block, best->least);
        if (bits != 0) {
            __builtin_prefetch(&block->row[0]);
            __builtin_prefetch(&block->row[CACHE_LINE / sizeof block->row[0]]);
        }
        wait_for_block(index, before, bits_before, &waiting, best);
        before = block;
        bits_before = bits;
    }
    wait_for_block(index, before, bits_before, &waiting, best);
    score_all_waiting(index, &waiting, best);
    explicit_bzero(index->bounds, ISO_METRIC_STEPS * sizeof *index->bounds);
}

static bool comes_before(const struct iso_search_hit *a, const struct iso_search_hit *b)
{
    return a->score > b->score || (a->score >= b->score && a->person < b->person);
}

int iso_index_search(const struct iso_index *index, const struct iso_metric_vector *probe,
                     struct iso_search_hit *hits, int capacity, int *n_hits)
{
    struct iso_score_terms *const terms = index->terms;
    struct candidate list[ISO_INDEX_HITS_MAX];
    struct best best = {.capacity = capacity, .least = -INFINITY, .candidate = list};
    struct iso_metric_vector person;
    if (probe->n != 1 || capacity < 0 || capacity > ISO_INDEX_HITS_MAX) {
        return -EINVAL;
    }
    for (int k = 0; k < ISO_METRIC_STEPS; k++) {
        if (index->people[k] > 0) {
            make_terms(index->metric, probe, k + ISO_METRIC_STEP_MIN, &terms[k]);
        }
    }
    if (capacity > 0 && index->filter && index->n >= PEOPLE_FOR_CODES) {
        scan_by_codes(index, &best);
    } else if (capacity > 0) {
        scan_everybody(index, &best);
    }
    for (int i = 0; i < best.n; i++) {
        iso__index_vector(index, list[i].at, &person);
        const struct iso_search_hit hit = {
            .person = index->row[list[i].at].person,
            .distance_mm = NAN,
            .score = iso_metric_score(index->metric, &person, probe),
        };
        int at = i;
        for (; at > 0 && comes_before(&hit, &hits[at - 1]); at--) {
            hits[at] = hits[at - 1];
        }
        hits[at] = hit;
    }
    explicit_bzero(terms, ISO_METRIC_STEPS * sizeof *terms);
    explicit_bzero(&person, sizeof person);
    *n_hits = best.n;
    return 0;
}
