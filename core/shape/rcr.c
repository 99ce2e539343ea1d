/* Relaxed collaborative representation (Yang, Zhang, Zhang and Wang, CVPR 2012; Abdelrahman 2013,
 * 4.7 and 4.8): each part y_k of a feature is coded over its own dictionary, the codes being held
 * together by weights that are optimised with them:
 *
 *     min sum_k |y_k - D_k a_k|^2 + lambda |a_k|^2 + tau w_k |a_k - mean|^2 + gamma w_k ln w_k
 *
 * over a_k, w_k and the mean in turn, each exactly, so that the sum falls until it settles. A part
 * that disagrees with the others gets a small weight. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/shape/collaborative.h"
#include "core/shape/gallery.h"

/* Parts being of unit length; of a few tried on generated creatures. */
static const double lambda = 0.1;
static const double tau = 0.5;
static const double gamma_entropy = 0.05;

enum { ROUNDS = 5 };

struct rcr {
    struct iso_gallery gallery; /* each part of a feature of unit length */
    int32_t n_parts;
    struct iso_dictionary part[ISO_SHAPE_PARTS_MAX];
};

struct code {
    float *y;
    double *memory;
    double *product[ISO_SHAPE_PARTS_MAX]; /* [n]: D_k y_k */
    double *alpha[ISO_SHAPE_PARTS_MAX];   /* [n] */
    double *mean, *right, *scratch;       /* [n], [n], [2 n] */
    double weight[ISO_SHAPE_PARTS_MAX];
};

static int code_init(struct code *code, const struct rcr *m)
{
    size_t n = (size_t)m->gallery.n, parts = (size_t)m->n_parts;
    *code = (struct code){0};
    code->y = malloc((size_t)m->gallery.layout.size * sizeof *code->y);
    code->memory = calloc((2 * parts + 4) * n, sizeof *code->memory);
    if (!code->y || !code->memory) {
        free(code->y);
        free(code->memory);
        return -ENOMEM;
    }
    for (size_t k = 0; k < parts; k++) {
        code->product[k] = &code->memory[2 * k * n];
        code->alpha[k] = &code->memory[(2 * k + 1) * n];
    }
    code->mean = &code->memory[2 * parts * n];
    code->right = code->mean + n;
    code->scratch = code->right + n;
    return 0;
}

static void code_done(struct code *code)
{
    free(code->y);
    free(code->memory);
}

/* The mean of the codes by their weights. */
static void average(const struct rcr *m, struct code *code)
{
    double sum = 0.0;
    memset(code->mean, 0, (size_t)m->gallery.n * sizeof *code->mean);
    for (int32_t k = 0; k < m->n_parts; k++) {
        sum += code->weight[k];
        for (int32_t i = 0; i < m->gallery.n; i++) {
            code->mean[i] += code->weight[k] * code->alpha[k][i];
        }
    }
    for (int32_t i = 0; i < m->gallery.n; i++) {
        code->mean[i] /= sum;
    }
}

/* w = exp(-1 - tau |a - mean|^2 / gamma), for which the derivative by w is 0. */
static void reweigh(const struct rcr *m, struct code *code)
{
    for (int32_t k = 0; k < m->n_parts; k++) {
        double square = 0.0;
        for (int32_t i = 0; i < m->gallery.n; i++) {
            double off = code->alpha[k][i] - code->mean[i];
            square += off * off;
        }
        code->weight[k] = exp(-1.0 - tau * square / gamma_entropy);
    }
}

static void find_code(const struct rcr *m, const float *feature, int32_t left, struct code *code)
{
    memcpy(code->y, feature, (size_t)m->gallery.layout.size * sizeof *feature);
    iso_gallery_normalise(&m->gallery.layout, code->y);
    const float *y = code->y;
    for (int32_t k = 0; k < m->n_parts; k++) {
        iso_dictionary_products(&m->part[k], y, code->product[k]);
        iso_dictionary_solve(&m->part[k], lambda, code->product[k], left, code->scratch,
                             code->alpha[k]);
        code->weight[k] = exp(-1.0);
        y += m->part[k].size;
    }
    for (int round = 0; round < ROUNDS; round++) {
        average(m, code);
        reweigh(m, code);
        average(m, code);
        for (int32_t k = 0; k < m->n_parts; k++) {
            double pull = tau * code->weight[k];
            for (int32_t i = 0; i < m->gallery.n; i++) {
                code->right[i] = code->product[k][i] + pull * code->mean[i];
            }
            iso_dictionary_solve(&m->part[k], lambda + pull, code->right, left, code->scratch,
                                 code->alpha[k]);
        }
    }
}

static void release(void *model)
{
    struct rcr *m = model;
    for (int32_t k = 0; k < m->n_parts; k++) {
        iso_dictionary_done(&m->part[k]);
    }
    iso_gallery_done(&m->gallery);
    free(m);
}

static int train(const struct iso_labelled *training, void **model)
{
    struct rcr *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    const struct iso_feature_layout *layout = training->layout;
    int error = iso_gallery_init(&m->gallery, training);
    for (int32_t i = 0; !error && i < training->n; i++) {
        iso_gallery_normalise(layout, &m->gallery.feature[(size_t)i * (size_t)layout->size]);
    }
    const float *atom = m->gallery.feature;
    for (int32_t k = 0; !error && k < layout->n_parts; k++) {
        error = iso_dictionary_init(&m->part[k], atom, training->n, layout->part_size[k],
                                    layout->size);
        m->n_parts += !error;
        atom += layout->part_size[k];
    }
    if (error) {
        release(m);
        return error;
    }
    *model = m;
    return 0;
}

/* |y_k - D_k a_k|^2 over the shapes of one class. */
static double class_residual(const struct rcr *m, const struct code *code, int32_t k,
                             const float *y, int32_t class, float *residual)
{
    const struct iso_dictionary *d = &m->part[k];
    double square = 0.0;
    memcpy(residual, y, (size_t)d->size * sizeof *residual);
    for (int32_t i = 0; i < d->n; i++) {
        const float *atom = &d->atom[(size_t)i * (size_t)d->stride];
        for (int32_t j = 0; m->gallery.label[i] == class && j < d->size; j++) {
            residual[j] -= (float)code->alpha[k][i] * atom[j];
        }
    }
    for (int32_t j = 0; j < d->size; j++) {
        square += (double)residual[j] * (double)residual[j];
    }
    return square;
}

/* sum_k w_k |y_k - D_k a_k|^2 of each class, as a score. */
static int score(const void *model, const float *feature, double *score)
{
    const struct rcr *m = model;
    const struct iso_gallery *g = &m->gallery;
    struct code code;
    float *residual = malloc((size_t)g->layout.size * sizeof *residual);
    int error = residual ? code_init(&code, m) : -ENOMEM;
    if (error) {
        free(residual);
        return error;
    }
    find_code(m, feature, -1, &code);
    for (int32_t c = 0; c < g->n_classes; c++) {
        const float *y = code.y;
        bool present = false;
        for (int32_t i = 0; i < g->n; i++) {
            present = present || g->label[i] == c;
        }
        score[c] = present ? 0.0 : -INFINITY;
        for (int32_t k = 0; k < m->n_parts; k++) {
            score[c] -= code.weight[k] * class_residual(m, &code, k, y, c, residual);
            y += m->part[k].size;
        }
    }
    code_done(&code);
    free(residual);
    return 0;
}

/* Each shape as a class of its own. */
static int rank(const void *model, const float *feature, int32_t left, double *distance)
{
    const struct rcr *m = model;
    struct code code;
    int error = code_init(&code, m);
    if (error) {
        return error;
    }
    find_code(m, feature, left, &code);
    double weight = 0.0;
    for (int32_t k = 0; k < m->n_parts; k++) {
        weight += code.weight[k];
    }
    for (int32_t i = 0; i < m->gallery.n; i++) {
        double square = 0.0;
        for (int32_t k = 0; i != left && k < m->n_parts; k++) {
            double a = code.alpha[k][i];
            square += code.weight[k] / weight * (1.0 - 2.0 * a * code.product[k][i] + a * a);
        }
        distance[i] = sqrt(fmax(0.0, square));
    }
    code_done(&code);
    return 0;
}

const struct iso_classifier_ops iso_classifier_rcr = {
    .name = "rcr",
    .title = "RCR",
    .source = "Yang, Zhang, Zhang and Wang 2012; Abdelrahman 2013, 4.8",
    .train = train,
    .free = release,
    .score = score,
    .rank = rank,
};
