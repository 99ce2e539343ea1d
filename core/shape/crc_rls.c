/* Collaborative representation based classification with regularised least squares (Zhang, Yang and
 * Feng, "Sparse representation or collaborative representation: which helps face recognition?",
 * ICCV 2011): y is coded over all shapes of all classes, and belongs to the class whose shapes take
 * the best part in that. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/shape/collaborative.h"
#include "core/shape/gallery.h"

/* The regularisation, features being of unit length. Ranking a gallery wants far more of it than
 * telling classes: with little, one shape of a class takes all of its part in the code. Of 0.01,
 * 0.1 and 1 tried on generated creatures. */
static const double lambda = 0.5;

struct crc {
    struct iso_gallery gallery; /* each part of a feature of unit length over the root of parts */
    struct iso_dictionary dictionary;
};

/* A query's code, and what it takes to get it. */
struct code {
    float *y;        /* [size] */
    double *product; /* [n]: D y */
    double *alpha;   /* [n] */
    double *scratch; /* [2 n] */
};

static int code_init(struct code *code, const struct crc *m)
{
    size_t n = (size_t)m->gallery.n;
    code->y = malloc((size_t)m->gallery.layout.size * sizeof *code->y);
    code->product = malloc(4 * n * sizeof *code->product);
    if (!code->y || !code->product) {
        free(code->y);
        free(code->product);
        return -ENOMEM;
    }
    code->alpha = &code->product[n];
    code->scratch = &code->product[2 * n];
    return 0;
}

static void code_done(struct code *code)
{
    free(code->y);
    free(code->product);
}

static void unit_length(const struct iso_feature_layout *layout, float *feature)
{
    iso_gallery_normalise(layout, feature);
    struct iso_feature_layout whole = {layout->size, 1, {layout->size}};
    iso_gallery_normalise(&whole, feature);
}

static void find_code(const struct crc *m, const float *feature, int32_t left, struct code *code)
{
    memcpy(code->y, feature, (size_t)m->gallery.layout.size * sizeof *feature);
    unit_length(&m->gallery.layout, code->y);
    iso_dictionary_products(&m->dictionary, code->y, code->product);
    iso_dictionary_solve(&m->dictionary, lambda, code->product, left, code->scratch, code->alpha);
}

static void release(void *model)
{
    struct crc *m = model;
    iso_dictionary_done(&m->dictionary);
    iso_gallery_done(&m->gallery);
    free(m);
}

static int train(const struct iso_labelled *training, void **model)
{
    struct crc *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    int error = iso_gallery_init(&m->gallery, training);
    int32_t size = training->layout->size;
    for (int32_t i = 0; !error && i < training->n; i++) {
        unit_length(training->layout, &m->gallery.feature[(size_t)i * (size_t)size]);
    }
    error = error
                ? error
                : iso_dictionary_init(&m->dictionary, m->gallery.feature, training->n, size, size);
    if (error) {
        release(m);
        return error;
    }
    *model = m;
    return 0;
}

/* |y - D_c alpha_c| / |alpha_c| of each class, as a score. */
static int score(const void *model, const float *feature, double *score)
{
    const struct crc *m = model;
    const struct iso_gallery *g = &m->gallery;
    struct code code;
    size_t size = (size_t)g->layout.size;
    float *residual = malloc(size * sizeof *residual);
    int error = residual ? code_init(&code, m) : -ENOMEM;
    if (error) {
        free(residual);
        return error;
    }
    find_code(m, feature, -1, &code);
    for (int32_t c = 0; c < g->n_classes; c++) {
        double square = 0.0, code_square = 0.0;
        memcpy(residual, code.y, size * sizeof *residual);
        for (int32_t i = 0; i < g->n; i++) {
            for (size_t k = 0; g->label[i] == c && k < size; k++) {
                residual[k] -= (float)code.alpha[i] * g->feature[(size_t)i * size + k];
            }
            code_square += g->label[i] == c ? code.alpha[i] * code.alpha[i] : 0.0;
        }
        for (size_t k = 0; k < size; k++) {
            square += (double)residual[k] * (double)residual[k];
        }
        score[c] = code_square > 0.0 ? -sqrt(square / code_square) : -INFINITY;
    }
    code_done(&code);
    free(residual);
    return 0;
}

/* Each shape as a class of its own: what is left of y without its share, |y - d_i alpha_i|. Not
 * over |alpha_i|, which is near 0 for most and puts them in no order. */
static int rank(const void *model, const float *feature, int32_t left, double *distance)
{
    const struct crc *m = model;
    struct code code;
    int error = code_init(&code, m);
    if (error) {
        return error;
    }
    find_code(m, feature, left, &code);
    for (int32_t i = 0; i < m->gallery.n; i++) {
        double a = code.alpha[i];
        distance[i] = i == left ? 0.0 : sqrt(fmax(0.0, 1.0 - 2.0 * a * code.product[i] + a * a));
    }
    code_done(&code);
    return 0;
}

const struct iso_classifier_ops iso_classifier_crc_rls = {
    .name = "crc-rls",
    .title = "CRC-RLS",
    .source = "Zhang, Yang and Feng 2011; Abdelrahman 2013, 4.2.2",
    .train = train,
    .free = release,
    .score = score,
    .rank = rank,
};
