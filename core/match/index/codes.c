#include "core/match/index/codes.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* The width of a step of the code in standard deviations of a number. */
static const float step_width = 1.0f / 24.0f;
/* Centres are at most this many steps away, and differences therefore this many and 128. */
static const double centre_most = 256.0;
/* The greatest weight of a code, and the greatest root of the sum of all squared weights: such a
 * difference stays in 16 bits, and the sum of all their squares in 31. */
static const double weight_most = 85.0, weights_most = 120.0;
/* By how much the range of a number is enlarged, and the rounding of codes, because codes are
 * computed in single precision. */
static const double range_share = 1e-4, step_share = 0.01;
/* A sum of some 25 products in single precision is off by less than this share of its terms. */
static const double rounding_share = 4e-6;

void iso_codes_init(struct iso_codes *codes, const struct iso_metric *metric)
{
    memset(codes, 0, sizeof *codes);
    codes->metric = metric;
    codes->n_numbers = metric->n_dimensions;
    const int coded = metric->n_dimensions < ISO_CODE_NUMBERS_MAX ? metric->n_dimensions
                                                                  : ISO_CODE_NUMBERS_MAX;
    codes->n_pairs = (coded + 1) / 2;
    for (int d = 0; d < coded; d++) {
        codes->width[d] = step_width * sqrtf(metric->between[d] + 1.0f);
    }
    for (int s = 0; s < ISO_METRIC_STEPS; s++) {
        codes->open[s] = -1;
    }
}

static void wipe_blocks(struct iso_codes *codes)
{
    if (codes->n_blocks > 0) {
        explicit_bzero(codes->block, codes->n_blocks * sizeof *codes->block);
    }
    free(codes->block);
}

void iso_codes_done(struct iso_codes *codes)
{
    wipe_blocks(codes);
    explicit_bzero(codes, sizeof *codes);
}

int iso_codes_reserve(struct iso_codes *codes, size_t n_people)
{
    /* Each step may have a block that is not full. */
    const size_t capacity = n_people / ISO_CODE_LANES + ISO_METRIC_STEPS;
    if (capacity <= codes->capacity) {
        return 0;
    }
    struct iso_code_block *block = calloc(capacity, sizeof *block);
    if (!block) {
        return -ENOMEM;
    }
    if (codes->n_blocks > 0) {
        memcpy(block, codes->block, codes->n_blocks * sizeof *block);
    }
    wipe_blocks(codes);
    codes->block = block;
    codes->capacity = capacity;
    return 0;
}

/* ---- people ---- */

static bool has_code(const struct iso_codes *codes, int d)
{
    return d < 2 * codes->n_pairs && d < codes->n_numbers;
}

static int8_t code_of(float z, float width)
{
    const float code = floorf(z / width);
    return code > -128.0f ? (int8_t)fminf(code, 127.0f) : -128;
}

/* The weight of a number without a code in the length of all of these: the more it tells people
 * apart, the more it weighs. Any positive weights give a bound. */
static float rest_weight(const struct iso_codes *codes, int d)
{
    const float b = codes->metric->between[d];
    return b / (1.0f + b) + FLT_MIN;
}

uint32_t iso_codes_put(struct iso_codes *codes, uint32_t row,
                       const struct iso_metric_vector *vector)
{
    int32_t *open = &codes->open[vector->step - ISO_METRIC_STEP_MIN];
    if (*open < 0) {
        *open = (int32_t)codes->n_blocks++;
        codes->block[*open].step = vector->step - ISO_METRIC_STEP_MIN;
        codes->block[*open].n = 0;
    }
    const uint32_t at = (uint32_t)*open;
    struct iso_code_block *block = &codes->block[at];
    const int lane = block->n++;
    block->row[lane] = row;
    float rest = 0.0f;
    for (int d = 0; d < codes->n_numbers; d++) {
        const float z = vector->scale * vector->mean[d];
        codes->most[d] = fmaxf(codes->most[d], fabsf(z));
        if (has_code(codes, d)) {
            block->code[(d / 2 * ISO_CODE_LANES + lane) * 2 + d % 2] = code_of(z, codes->width[d]);
        } else {
            rest += rest_weight(codes, d) * z * z;
        }
    }
    codes->rest_most = fmaxf(codes->rest_most, sqrtf(rest));
    if (block->n == ISO_CODE_LANES) {
        *open = -1;
    }
    return at * ISO_CODE_LANES + (uint32_t)lane;
}

static void move_codes(struct iso_codes *codes, const struct iso_code_block *from, int from_lane,
                       struct iso_code_block *to, int to_lane)
{
    for (int p = 0; p < codes->n_pairs; p++) {
        memcpy(&to->code[(p * ISO_CODE_LANES + to_lane) * 2],
               &from->code[(p * ISO_CODE_LANES + from_lane) * 2], 2);
    }
    to->row[to_lane] = from->row[from_lane];
}

/* Removes an empty block. The last one takes its place. */
static void remove_block(struct iso_codes *codes, uint32_t at, iso_codes_moved *moved, void *owner)
{
    struct iso_code_block *block = &codes->block[at], *last = &codes->block[--codes->n_blocks];
    codes->open[block->step] = -1;
    if (block != last) {
        *block = *last;
        if (block->n < ISO_CODE_LANES) {
            codes->open[block->step] = (int32_t)at;
        }
        for (int i = 0; i < block->n; i++) {
            moved(owner, block->row[i], at * ISO_CODE_LANES + (uint32_t)i);
        }
    }
    explicit_bzero(last, sizeof *last);
}

void iso_codes_remove(struct iso_codes *codes, uint32_t place, iso_codes_moved *moved, void *owner)
{
    struct iso_code_block *block = &codes->block[place / ISO_CODE_LANES];
    int32_t *open = &codes->open[block->step];
    if (*open < 0) {
        *open = (int32_t)(place / ISO_CODE_LANES);
    }
    const uint32_t from = (uint32_t)*open;
    struct iso_code_block *giver = &codes->block[from];
    giver->n--;
    if (giver != block || giver->n != (int)(place % ISO_CODE_LANES)) {
        move_codes(codes, giver, giver->n, block, (int)(place % ISO_CODE_LANES));
        moved(owner, giver->row[giver->n], place);
    }
    if (giver->n == 0) {
        remove_block(codes, from, moved, owner);
    }
}

void iso_codes_set_row(struct iso_codes *codes, uint32_t place, uint32_t row)
{
    codes->block[place / ISO_CODE_LANES].row[place % ISO_CODE_LANES] = row;
}

/* ---- bounds ---- */

/* The place of the greatest weight z + square z^2. */
static double summit_of(double weight, double square)
{
    return square < 0.0 ? -0.5 * weight / square : copysign(INFINITY, weight);
}

/* Where a number with a code counts as greatest. */
struct summit {
    double value;  /* no value of the term is greater by more than its square from the centre */
    double centre; /* steps of the code */
};

/* If no code was limited, all z lie before a centre that is further away than any code; beyond the
 * centre the term would rise further. Otherwise the place is the projection of the summit to the
 * range of all z, and centre and codes are limited alike. Both ways the term falls at least by the
 * square of the distance from the place. */
static struct summit centre_of(const struct iso_codes *codes, int d, double weight, double square)
{
    const double width = (double)codes->width[d];
    const double range = (double)codes->most[d] * (1.0 + range_share);
    const double far = range < 127.0 * width ? centre_most * width : range;
    const double z = fmin(fmax(summit_of(weight, square), -far), far);
    const double most = range < 127.0 * width ? centre_most : 128.0;
    return (struct summit){weight * z + square * z * z, fmin(fmax(z / width, -most), most)};
}

/* The unit of the differences: as small as the weights of all codes allow. */
static double unit_of(const struct iso_codes *codes, const struct iso_score_terms *terms)
{
    double sum = 0.0, largest = 0.0;
    for (int d = 0; d < codes->n_numbers && has_code(codes, d); d++) {
        const double step2 = -(double)terms->square[d] * (double)codes->width[d] *
                             (double)codes->width[d];
        sum += step2;
        largest = fmax(largest, step2);
    }
    return fmax(fmax(sqrt(sum) / weights_most, sqrt(largest) / weight_most), DBL_MIN);
}

/* Adds a number with a code, which stands for the middle of its step, to the bounds. Returns the
 * square of its error. */
static double add_code(const struct iso_codes *codes, const struct iso_score_terms *terms, int d,
                       struct iso_code_bounds *bounds)
{
    const double w = (double)terms->weight[d], s = (double)terms->square[d];
    const struct summit summit = centre_of(codes, d, w, s);
    const double weight = floor(sqrt(-s) * (double)codes->width[d] / bounds->unit);
    const double error = weight * (0.5 + step_share) + 0.5;
    bounds->probe.weight[d] = (int16_t)weight;
    bounds->probe.centre[d] = (int16_t)rint(weight * (summit.centre - 0.5));
    bounds->highest += summit.value;
    return error * error;
}

void iso_codes_bound(const struct iso_codes *codes, const struct iso_score_terms *terms,
                     struct iso_code_bounds *bounds)
{
    double sum = fabs(terms->constant), error2 = 0.0, rest2 = 0.0, edges = 0.0;
    memset(bounds, 0, sizeof *bounds);
    bounds->highest = terms->constant;
    bounds->unit = unit_of(codes, terms);
    for (int d = 0; d < codes->n_numbers; d++) {
        const double w = fabs((double)terms->weight[d]), s = (double)terms->square[d];
        const double range = (double)codes->most[d] * (1.0 + range_share);
        sum += range * (w - s * range);
        if (has_code(codes, d)) {
            error2 += add_code(codes, terms, d, bounds);
        } else {
            rest2 += w * w / (double)rest_weight(codes, d);
            edges += w * range;
        }
    }
    bounds->highest += fmin(edges, sqrt(rest2) * (double)codes->rest_most * (1.0 + range_share));
    bounds->rounding = rounding_share * sum;
    bounds->error = sqrt(error2);
}

int32_t iso_code_limit(const struct iso_code_bounds *bounds, double least)
{
    const double left = bounds->highest + bounds->rounding - least;
    if (!(left >= 0.0)) {
        return -1;
    }
    const double root = sqrt(left) / bounds->unit + bounds->error;
    return (int32_t)fmin(root * root, INT32_MAX);
}
