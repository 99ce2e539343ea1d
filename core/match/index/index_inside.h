/* The memory of an index (isotherm/index.h). Internal to core/match/index, and to its test. */
#ifndef ISO_CORE_MATCH_INDEX_INDEX_INSIDE_H
#define ISO_CORE_MATCH_INDEX_INDEX_INSIDE_H

#include "core/match/index/codes.h"
#include "isotherm/index.h"

struct iso_index_row {
    int64_t person;
    float scale, weight; /* of the vector */
    uint32_t place;      /* of its codes */
    int8_t step;
    uint8_t n; /* templates */
};

struct iso_index {
    const struct iso_metric *metric;
    size_t stride; /* floats of a vector: the dimensions, filled up to a multiple of ISO_LANES */
    size_t n, capacity;
    struct iso_index_row *row;       /* by rising person */
    float *mean;                     /* [capacity][stride] */
    size_t people[ISO_METRIC_STEPS]; /* how many people have vectors of each step */
    struct iso_codes codes;
    iso_code_filter *filter;        /* NULL: a search scores everybody */
    struct iso_score_terms *terms;  /* [ISO_METRIC_STEPS] working memory of a search */
    struct iso_code_bounds *bounds; /* [ISO_METRIC_STEPS] the same */
};

static inline float *iso__index_mean(const struct iso_index *index, size_t row)
{
    return &index->mean[row * index->stride];
}

/* Copies the vector of a row. */
void iso__index_vector(const struct iso_index *index, size_t row, struct iso_metric_vector *out);

#endif
