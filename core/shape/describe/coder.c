/* From descriptions to features (isotherm/shape_method.h). */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/shape/describe/principal.h"
#include "core/shape/describe/vocabulary.h"
#include "isotherm/shape_method.h"

/* Rows that vocabularies learn from, taken evenly from all shapes. */
enum { LEARN_ROWS = 20000 };

struct iso_shape_coder {
    const struct iso_shape_method *method;
    struct iso_feature_layout layout;
    /* The sizes of the descriptions. */
    int32_t n_bags, n_values, n_parts;
    int32_t part_size[ISO_SHAPE_PARTS_MAX];
    struct iso_principal principal; /* of ISO_CODING_REDUCED */
    struct iso_vocabulary vocabulary[ISO_SHAPE_BAGS_MAX];
};

static bool looks_right(const struct iso_shape_coder *c, const struct iso_shape_description *d)
{
    return d->n_bags == c->n_bags && d->n_values == c->n_values && d->n_parts == c->n_parts &&
           memcmp(d->part_size, c->part_size, sizeof d->part_size) == 0;
}

static int learn_principal(struct iso_shape_coder *c,
                           const struct iso_shape_description *const *training, int32_t n,
                           int32_t size)
{
    const float **vector = calloc((size_t)n, sizeof *vector);
    for (int32_t i = 0; vector && i < n; i++) {
        vector[i] = training[i]->whole;
    }
    const int error = vector ? iso_principal_init(vector, n, c->part_size[0], size, &c->principal)
                             : -ENOMEM;
    free(vector);
    return error;
}

/* Copies rows of one bag of all shapes at even steps, at most LEARN_ROWS. Returns how many. */
static int32_t gather_rows(const struct iso_shape_description *const *training, int32_t n,
                           int32_t bag, float *row)
{
    int64_t all = 0, at = 0;
    int32_t taken = 0;
    for (int32_t i = 0; i < n; i++) {
        all += training[i]->n_points;
    }
    const int64_t step = all / LEARN_ROWS + 1;
    for (int32_t i = 0; i < n; i++) {
        const struct iso_shape_description *d = training[i];
        const size_t size = (size_t)d->n_values;
        const float *local = &d->local[(size_t)bag * (size_t)d->n_points * size];
        for (int32_t p = 0; p < d->n_points; p++, at++) {
            if (at % step == 0) {
                memcpy(&row[(size_t)taken++ * size], &local[(size_t)p * size], size * sizeof *row);
            }
        }
    }
    return taken;
}

static int learn_vocabularies(struct iso_shape_coder *c,
                              const struct iso_shape_description *const *training, int32_t n,
                              int32_t size, uint64_t seed)
{
    float *row = calloc((size_t)LEARN_ROWS * (size_t)c->n_values, sizeof *row);
    int error = row ? 0 : -ENOMEM;
    for (int32_t b = 0; !error && b < c->n_bags; b++) {
        const int32_t rows = gather_rows(training, n, b, row);
        error = iso_vocabulary_init(row, rows, c->n_values, size, seed + (uint64_t)b,
                                    &c->vocabulary[b]);
    }
    free(row);
    return error;
}

/* Sets the parts of a feature from what was learned. */
static void lay_out(struct iso_shape_coder *c)
{
    struct iso_feature_layout *layout = &c->layout;
    layout->norm = c->method->norm;
    for (int32_t b = 0; b < c->n_bags; b++) {
        layout->part_size[layout->n_parts++] = c->vocabulary[b].n_words;
    }
    for (int32_t p = 0; p < c->n_parts; p++) {
        const bool reduced = c->method->coding == ISO_CODING_REDUCED && p == 0;
        const int32_t size = reduced ? c->principal.n_components : c->part_size[p];
        if (size > 0) {
            layout->part_size[layout->n_parts++] = size;
        }
    }
    for (int32_t p = 0; p < layout->n_parts; p++) {
        layout->size += layout->part_size[p];
    }
}

int iso_shape_coder_new(const struct iso_shape_method *method,
                        const struct iso_shape_description *const *training, int32_t n,
                        int32_t size, uint64_t seed, struct iso_shape_coder **out)
{
    if (n < 1 || size < 0) {
        return -EINVAL;
    }
    struct iso_shape_coder *c = calloc(1, sizeof *c);
    if (!c) {
        return -ENOMEM;
    }
    c->method = method;
    c->n_bags = training[0]->n_bags;
    c->n_values = training[0]->n_values;
    c->n_parts = training[0]->n_parts;
    memcpy(c->part_size, training[0]->part_size, sizeof c->part_size);
    int error = c->n_bags + c->n_parts > ISO_SHAPE_PARTS_MAX ? -EINVAL : 0;
    for (int32_t i = 1; i < n && !error; i++) {
        error = looks_right(c, training[i]) ? 0 : -EINVAL;
    }
    size = size ? size : method->size;
    if (!error && method->coding == ISO_CODING_REDUCED) {
        error = learn_principal(c, training, n, size);
    } else if (!error && method->coding == ISO_CODING_BAGS) {
        error = learn_vocabularies(c, training, n, size, seed);
    }
    if (error) {
        iso_shape_coder_free(c);
        return error;
    }
    lay_out(c);
    *out = c;
    return 0;
}

void iso_shape_coder_free(struct iso_shape_coder *coder)
{
    if (coder) {
        iso_principal_done(&coder->principal);
        for (int b = 0; b < ISO_SHAPE_BAGS_MAX; b++) {
            iso_vocabulary_done(&coder->vocabulary[b]);
        }
        free(coder);
    }
}

const struct iso_feature_layout *iso_shape_coder_layout(const struct iso_shape_coder *coder)
{
    return &coder->layout;
}

int iso_shape_code(const struct iso_shape_coder *c, const struct iso_shape_description *d,
                   float *feature)
{
    if (!looks_right(c, d)) {
        return -EINVAL;
    }
    memset(feature, 0, (size_t)c->layout.size * sizeof *feature);
    for (int32_t b = 0; b < c->n_bags; b++) {
        const float *local = &d->local[(size_t)b * (size_t)d->n_points * (size_t)d->n_values];
        iso_vocabulary_count(&c->vocabulary[b], local, d->weight, d->n_points, feature);
        feature += c->vocabulary[b].n_words;
    }
    const float *part = d->whole;
    for (int32_t p = 0; p < d->n_parts; p++) {
        if (c->method->coding == ISO_CODING_REDUCED && p == 0) {
            iso_principal_project(&c->principal, part, feature);
            feature += c->principal.n_components;
        } else {
            memcpy(feature, part, (size_t)d->part_size[p] * sizeof *feature);
            feature += d->part_size[p];
        }
        part += d->part_size[p];
    }
    return 0;
}
