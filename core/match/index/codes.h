/* Coarse copies of the vectors of an index: a code of eight bits for each of the first numbers. A
 * search computes from a person's codes a bound that the score cannot exceed, and looks at the
 * vector itself only if the bound is among the best. The best people are exactly those of a search
 * that looks at all vectors. Internal to core/match/index.
 *
 * With z = scale * y, number d adds weight z + square z^2 to the score, where square <= 0. This is
 * greatest at some c, and falls by |square| (z - c)^2. A code is z in steps of 1/24 of its standard
 * deviation, rounded down and limited to eight bits. The bound is what a person would score with
 * all coded numbers at c, less these squares. The differences of codes are off by at most half a
 * step and by the rounding of the probe; by the triangle inequality the root of the sum of squares
 * is then off by at most the length of these errors. If c lies outside the range of all z seen so
 * far, a nearer place takes its place (codes.c, centre_of).
 *
 * The other numbers hardly tell people apart. Their part of the score is bounded for all people at
 * once: by the inequality of Cauchy and Schwarz with the longest vector of them seen so far.
 *
 * Only people of one step have the same weights. A block therefore has people of one step. All
 * blocks but one of a step are full, and the blocks lie one after the other, so that a search reads
 * memory from front to back. */
#ifndef ISO_CORE_MATCH_INDEX_CODES_H
#define ISO_CORE_MATCH_INDEX_CODES_H

#include <stddef.h>

#include "core/base/lanes.h"
#include "core/match/index/code_filter.h"
#include "isotherm/metric.h"

enum {
    ISO_SCORE_TERMS_MAX = (ISO_METRIC_DIMENSIONS_MAX + ISO_LANES - 1) / ISO_LANES * ISO_LANES,
};

/* 32 people of one step. */
struct iso_code_block {
    int8_t code[ISO_CODE_NUMBERS_MAX * ISO_CODE_LANES]; /* [n_pairs][ISO_CODE_LANES][2] */
    uint32_t row[ISO_CODE_LANES];                       /* of the index: whose codes these are */
    int32_t step;                                       /* less ISO_METRIC_STEP_MIN */
    int32_t n;                                          /* people in it */
};

struct iso_codes {
    const struct iso_metric *metric;
    int n_numbers, n_pairs;                /* of the metric; those that have codes, in pairs */
    float width[ISO_CODE_NUMBERS_MAX];     /* of a step of the code */
    float most[ISO_METRIC_DIMENSIONS_MAX]; /* greatest |z| of each number so far */
    float rest_most; /* greatest length of the numbers without codes so far; see rest_weight() */
    size_t n_blocks, capacity;      /* blocks */
    struct iso_code_block *block;   /* [capacity] */
    int32_t open[ISO_METRIC_STEPS]; /* the block of each step that is not full, or -1 */
};

/* The coefficients of the score of one probe, for people of one step. A person with the numbers y,
 * not yet scaled, has the score constant + scale * sum weight y + scale^2 * sum square y^2. */
struct iso_score_terms {
    double constant;
    float weight[ISO_SCORE_TERMS_MAX], square[ISO_SCORE_TERMS_MAX]; /* 0 from n_numbers on */
};

/* The bounds of one probe for people of one step. */
struct iso_code_bounds {
    double highest;  /* no score is higher: that of a person with all coded numbers at c */
    double rounding; /* how far a score may be off in single precision */
    double unit;     /* of the differences of codes: their squares times unit^2 are scores */
    double error;    /* how far the root of a sum of squares may be off, in these units */
    struct iso_code_probe probe;
};

/* Makes codes without people and without memory. */
void iso_codes_init(struct iso_codes *codes, const struct iso_metric *metric);

/* Wipes and frees the memory. */
void iso_codes_done(struct iso_codes *codes);

/* Makes room for n people. -ENOMEM, and nothing has changed. */
int iso_codes_reserve(struct iso_codes *codes, size_t n_people) __attribute__((warn_unused_result));

/* Adds a person, for whom there is room. Returns the place of the codes. */
uint32_t iso_codes_put(struct iso_codes *codes, uint32_t row,
                       const struct iso_metric_vector *vector);

/* Says how the owner learns that the codes of a row have moved to another place. */
typedef void iso_codes_moved(void *owner, uint32_t row, uint32_t place);

/* Removes the codes at a place. Others take the place, and the owner is told so. */
void iso_codes_remove(struct iso_codes *codes, uint32_t place, iso_codes_moved *moved, void *owner);

/* Tells that the person whose codes are at this place has another row of the index now. */
void iso_codes_set_row(struct iso_codes *codes, uint32_t place, uint32_t row);

/* Computes the bounds of the terms. */
void iso_codes_bound(const struct iso_codes *codes, const struct iso_score_terms *terms,
                     struct iso_code_bounds *bounds);

/* The greatest sum of squares with which a person may still score `least` or more; -1 if nobody
 * does. */
int32_t iso_code_limit(const struct iso_code_bounds *bounds, double least);

#endif
