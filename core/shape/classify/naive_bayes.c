/* Naive Bayes with normal densities (John and Langley, UAI 1995): the values of a feature are
 * assumed to be independent. OpenCV's classifier of normal densities is not naive: it needs the
 * inverse of a covariance matrix, which a dozen shapes with hundreds of values do not have. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/shape/classify/training_set.h"

/* The least variance of a value within a class, relative to its variance in all shapes. A bin of a
 * histogram that is empty in a dozen shapes may not be empty in the next one. */
static const double least_variance = 0.05;

struct bayes {
    int32_t size, n_classes;
    double *mean, *variance; /* [n_classes][size]; a value with variance 0 is ignored */
    double *prior;           /* [n_classes]: logarithm of the share of the class */
};

static void release(void *model)
{
    struct bayes *m = model;
    free(m->mean);
    free(m->variance);
    free(m->prior);
    free(m);
}

/* Mean and variance of value k in one class, or in all classes for -1. Returns the number of
 * shapes. */
static int32_t moments(const struct iso_labelled *t, int32_t class, int32_t k, double *mean,
                       double *variance)
{
    double sum = 0.0, square = 0.0;
    int32_t n = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t i = 0; i < t->n; i++) {
            if (class < 0 || t->label[i] == class) {
                const double x = (double)
                                     t->feature[(size_t)i * (size_t)t->layout->size + (size_t)k];
                n += pass == 0;
                sum += pass == 0 ? x : 0.0;
                square += pass == 0 ? 0.0 : (x - sum / n) * (x - sum / n);
            }
        }
    }
    *mean = n > 0 ? sum / n : 0.0;
    *variance = n > 0 ? square / n : 0.0;
    return n;
}

static int train(const struct iso_labelled *training, void **model)
{
    struct bayes *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    size_t size = (size_t)training->layout->size, classes = (size_t)training->n_classes;
    m->size = training->layout->size;
    m->n_classes = training->n_classes;
    m->mean = calloc(classes * size, sizeof *m->mean);
    m->variance = calloc(classes * size, sizeof *m->variance);
    m->prior = calloc(classes, sizeof *m->prior);
    if (!m->mean || !m->variance || !m->prior) {
        release(m);
        return -ENOMEM;
    }
    for (int32_t k = 0; k < m->size; k++) {
        double mean, variance;
        moments(training, -1, k, &mean, &variance);
        for (int32_t c = 0; c < m->n_classes; c++) {
            const size_t at = (size_t)c * size + (size_t)k;
            const int32_t n = moments(training, c, k, &m->mean[at], &m->variance[at]);
            m->variance[at] = fmax(m->variance[at], least_variance * variance);
            m->prior[c] = n > 0 ? log((double)n / training->n) : -INFINITY;
        }
    }
    *model = m;
    return 0;
}

static int score(const void *model, const float *feature, double *score)
{
    const struct bayes *m = model;
    for (int32_t c = 0; c < m->n_classes; c++) {
        score[c] = m->prior[c];
        for (int32_t k = 0; k < m->size; k++) {
            const size_t at = (size_t)c * (size_t)m->size + (size_t)k;
            double off = (double)feature[k] - m->mean[at], variance = m->variance[at];
            if (variance > 0.0) {
                score[c] -= 0.5 * (off * off / variance + log(2.0 * M_PI * variance));
            }
        }
    }
    return 0;
}

const struct iso_classifier_ops iso_classifier_naive_bayes = {
    .name = "naive-bayes",
    .title = "Naive Bayes",
    .source = "John and Langley 1995",
    .train = train,
    .free = release,
    .score = score,
};
