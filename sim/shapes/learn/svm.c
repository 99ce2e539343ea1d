/* Support vector machines by libsvm. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <libsvm/svm.h>

#include "core/shape/classify/standard.h"
#include "sim/shapes/learn/ops.h"

/* The kernel is linear, because a feature has more values than there are samples. Features are
 * standardised as for collaborative coding (standard.h): one shape far from all others would
 * otherwise determine the range of a value, and leave the others little of it. How they are
 * compressed, and the cost C, are chosen by cross-validation on the training set, as libsvm's guide
 * recommends (Hsu, Chang and Lin 2003). */
static const double costs[] = {1.0, 10.0, 100.0};
enum { COSTS = sizeof costs / sizeof *costs, FOLDS = 3 };

struct machine {
    int32_t n, size, n_classes;
    struct svm_node *node; /* [n][size + 1], which the model refers to */
    struct svm_node **row; /* [n] */
    double *label;         /* [n] */
    struct iso_standard standard;
    struct svm_model *model;
};

static void quiet(const char *text)
{
    (void)text;
}

static void release(void *model)
{
    struct machine *m = model;
    if (m->model) {
        svm_free_and_destroy_model(&m->model);
    }
    free(m->node);
    free(m->row);
    free(m->label);
    iso_standard_done(&m->standard);
    free(m);
}

static struct machine *machine_of(const struct iso_labelled *t)
{
    struct machine *m = calloc(1, sizeof *m);
    if (!m) {
        return NULL;
    }
    m->n = t->n;
    m->size = t->layout->size;
    m->n_classes = t->n_classes;
    m->node = calloc((size_t)m->n * ((size_t)m->size + 1), sizeof *m->node);
    m->row = calloc((size_t)m->n, sizeof *m->row);
    m->label = calloc((size_t)m->n, sizeof *m->label);
    if (m->node && m->row && m->label) {
        return m;
    }
    release(m);
    return NULL;
}

static int fill_row(const struct machine *m, const float *feature, struct svm_node *row)
{
    float *own = calloc((size_t)m->size, sizeof *own);
    if (!own) {
        return -ENOMEM;
    }
    memcpy(own, feature, (size_t)m->size * sizeof *own);
    iso_standard_apply(&m->standard, own);
    for (int32_t k = 0; k < m->size; k++) {
        row[k] = (struct svm_node){k + 1, (double)own[k]};
    }
    row[m->size] = (struct svm_node){-1, 0.0};
    free(own);
    return 0;
}

/* Takes the features in. Those of one class follow those of another, so that each fold has some of
 * each class. */
static int fill(const struct iso_labelled *t, enum iso_compression compression, struct machine *m)
{
    int error = iso_standard_init(&m->standard, t, compression, 1.0);
    int32_t n = 0;
    for (int32_t c = 0; c < t->n_classes; c++) {
        for (int32_t i = 0; i < t->n && !error; i++) {
            if (t->label[i] == c) {
                m->row[n] = &m->node[(size_t)n * ((size_t)m->size + 1)];
                m->label[n] = c;
                error = fill_row(m, &t->feature[(size_t)i * (size_t)m->size], m->row[n++]);
            }
        }
    }
    return error;
}

static struct svm_model *learn(const struct svm_problem *problem, double cost)
{
    const struct svm_parameter parameter = {.svm_type = C_SVC,
                                            .kernel_type = LINEAR,
                                            .cache_size = 16,
                                            .eps = 1e-3,
                                            .C = cost,
                                            .shrinking = 1};
    return svm_check_parameter(problem, &parameter) ? NULL : svm_train(problem, &parameter);
}

/* How many samples are told by machines that have not learnt from them. svm_cross_validation()
 * draws its folds by rand(), which threads share. */
static int cross_validate(const struct machine *m, double cost, int32_t *right)
{
    struct svm_problem part = {0, calloc((size_t)m->n, sizeof(double)),
                               calloc((size_t)m->n, sizeof(struct svm_node *))};
    int error = part.y && part.x ? 0 : -ENOMEM;
    *right = 0;
    for (int fold = 0; fold < FOLDS && !error; fold++) {
        part.l = 0;
        for (int32_t i = 0; i < m->n; i++) {
            if (i % FOLDS != fold) {
                part.y[part.l] = m->label[i];
                part.x[part.l++] = m->row[i];
            }
        }
        struct svm_model *model = part.l > 0 ? learn(&part, cost) : NULL;
        for (int32_t i = fold; model && i < m->n; i += FOLDS) {
            const int told = (int)svm_predict(model, m->row[i]);
            *right += told == (int)m->label[i];
        }
        svm_free_and_destroy_model(&model);
    }
    free(part.y);
    free(part.x);
    return error;
}

/* Tries the costs with one way to compress the features. Keeps the machine and its cost in `best`
 * if more than `most` samples are told. */
static int try_compression(const struct iso_labelled *training, enum iso_compression compression,
                           int32_t *most, double *cost, struct machine **best)
{
    struct machine *m = machine_of(training);
    int error = m ? fill(training, compression, m) : -ENOMEM;
    bool better = false;
    for (int c = 0; c < COSTS && !error; c++) {
        int32_t right = 0;
        error = cross_validate(m, costs[c], &right);
        if (!error && right > *most) {
            *most = right;
            *cost = costs[c];
            better = true;
        }
    }
    if (m && better && !error) {
        struct machine *former = *best;
        *best = m;
        m = former;
    }
    if (m) {
        release(m);
    }
    return error;
}

static int train(const struct iso_labelled *training, void **model)
{
    const bool compressible = iso_standard_compressible(training);
    struct machine *m = NULL;
    int32_t most = -1;
    double cost = costs[0];
    svm_set_print_string_function(quiet);
    int error = try_compression(
        training, compressible ? ISO_COMPRESSION_ROOT : ISO_COMPRESSION_NONE, &most, &cost, &m);
    if (!error && compressible) {
        error = try_compression(training, ISO_COMPRESSION_LOGARITHM, &most, &cost, &m);
    }
    if (!error) {
        const struct svm_problem problem = {m->n, m->label, m->row};
        m->model = learn(&problem, cost);
        error = m->model ? 0 : -EINVAL;
    }
    if (error) {
        if (m) {
            release(m);
        }
        return error;
    }
    *model = m;
    return 0;
}

/* Each pair of classes divides one vote between its two classes, by a logistic function of the
 * decision value. The score of a class is the sum of its parts; -INFINITY for a class without
 * training samples. */
static int score(const void *model, const float *feature, double *score)
{
    const struct machine *m = model;
    const int classes = svm_get_nr_class(m->model);
    struct svm_node *row = calloc((size_t)m->size + 1, sizeof *row);
    double *decision = calloc((size_t)classes * (size_t)classes + 1, sizeof *decision);
    int *label = calloc((size_t)classes, sizeof *label);
    int error = row && decision && label ? 0 : -ENOMEM;
    if (!error) {
        error = fill_row(m, feature, row);
    }
    if (!error) {
        svm_get_labels(m->model, label);
        svm_predict_values(m->model, row, decision);
        for (int32_t c = 0; c < m->n_classes; c++) {
            score[c] = -INFINITY;
        }
        for (int i = 0; i < classes; i++) {
            score[label[i]] = 0.0;
        }
        const double *d = decision;
        for (int i = 0; i < classes; i++) {
            for (int j = i + 1; j < classes; j++, d++) {
                score[label[i]] += 1.0 / (1.0 + exp(-2.0 * *d));
                score[label[j]] += 1.0 / (1.0 + exp(2.0 * *d));
            }
        }
    }
    free(row);
    free(decision);
    free(label);
    return error;
}

const struct iso_classifier_ops iso_learn_svm = {
    .name = "svm",
    .title = "SVM",
    .source = "Chang and Lin 2011 (libsvm)",
    .train = train,
    .free = release,
    .score = score,
};
