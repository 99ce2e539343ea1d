/* Support vector machines by libsvm. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include <libsvm/svm.h>

#include "sim/shapes/learn/ops.h"

/* A linear kernel is sufficient, because a feature has more values than there are samples. Values
 * are scaled to 0..1 by the range of the training data, as libsvm's guide recommends (Hsu, Chang
 * and Lin 2003). */
static const double cost = 1.0;

struct machine {
    int32_t n, size, n_classes;
    struct svm_node *node; /* [n][size + 1], which the model refers to */
    struct svm_node **row; /* [n] */
    double *label;         /* [n] */
    double *least, *scale; /* [size] */
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
    free(m->least);
    free(m->scale);
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
    m->least = calloc((size_t)m->size, sizeof *m->least);
    m->scale = calloc((size_t)m->size, sizeof *m->scale);
    if (m->node && m->row && m->label && m->least && m->scale) {
        return m;
    }
    release(m);
    return NULL;
}

static void find_scale(const struct iso_labelled *t, struct machine *m)
{
    for (int32_t k = 0; k < m->size; k++) {
        double least = INFINITY, most = -INFINITY;
        for (int32_t i = 0; i < m->n; i++) {
            const double value = (double)t->feature[(size_t)i * (size_t)m->size + (size_t)k];
            least = fmin(least, value);
            most = fmax(most, value);
        }
        m->least[k] = least;
        m->scale[k] = most > least ? 1.0 / (most - least) : 0.0;
    }
}

static void fill_row(const struct machine *m, const float *feature, struct svm_node *row)
{
    for (int32_t k = 0; k < m->size; k++) {
        row[k] = (struct svm_node){k + 1, ((double)feature[k] - m->least[k]) * m->scale[k]};
    }
    row[m->size] = (struct svm_node){-1, 0.0};
}

static int train(const struct iso_labelled *training, void **model)
{
    struct machine *m = machine_of(training);
    if (!m) {
        return -ENOMEM;
    }
    find_scale(training, m);
    for (int32_t i = 0; i < m->n; i++) {
        m->row[i] = &m->node[(size_t)i * ((size_t)m->size + 1)];
        m->label[i] = training->label[i];
        fill_row(m, &training->feature[(size_t)i * (size_t)m->size], m->row[i]);
    }
    const struct svm_problem problem = {m->n, m->label, m->row};
    const struct svm_parameter parameter = {.svm_type = C_SVC,
                                            .kernel_type = LINEAR,
                                            .cache_size = 16,
                                            .eps = 1e-3,
                                            .C = cost,
                                            .shrinking = 1};
    svm_set_print_string_function(quiet);
    m->model = svm_check_parameter(&problem, &parameter) ? NULL : svm_train(&problem, &parameter);
    if (!m->model) {
        release(m);
        return -EINVAL;
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
    const int error = row && decision && label ? 0 : -ENOMEM;
    if (!error) {
        fill_row(m, feature, row);
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
