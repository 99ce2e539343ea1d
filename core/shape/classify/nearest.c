/* Nearest neighbour (Cover and Hart 1967): the class of the closest feature. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/shape/classify/training_set.h"

static int train(const struct iso_labelled *training, void **model)
{
    struct iso_training_set *g = calloc(1, sizeof *g);
    const int error = g ? iso_training_set_init(g, training) : -ENOMEM;
    if (error) {
        free(g);
        return error;
    }
    *model = g;
    return 0;
}

static void release(void *model)
{
    iso_training_set_done(model);
    free(model);
}

static double l1(const float *a, const float *b, int32_t n)
{
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) {
        sum += fabs((double)a[i] - (double)b[i]);
    }
    return sum;
}

static double l2(const float *a, const float *b, int32_t n)
{
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) {
        sum += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
    }
    return sqrt(sum);
}

static int rank_by(const struct iso_training_set *g, const float *feature, int32_t left,
                   double (*norm)(const float *, const float *, int32_t), double *distance)
{
    for (int32_t i = 0; i < g->n; i++) {
        const float *other = &g->feature[(size_t)i * (size_t)g->layout.size];
        distance[i] = i == left ? 0.0 : norm(feature, other, g->layout.size);
    }
    return 0;
}

static int rank_l1(const void *model, const float *feature, int32_t left, double *distance)
{
    return rank_by(model, feature, left, l1, distance);
}

static int rank_l2(const void *model, const float *feature, int32_t left, double *distance)
{
    return rank_by(model, feature, left, l2, distance);
}

static int score_by(const struct iso_training_set *g, const float *feature,
                    int (*rank)(const void *, const float *, int32_t, double *), double *score)
{
    double *distance = malloc((size_t)g->n * sizeof *distance);
    const int error = distance ? rank(g, feature, -1, distance) : -ENOMEM;
    if (!error) {
        iso_training_set_score(g, distance, score);
    }
    free(distance);
    return error;
}

static int score_l1(const void *model, const float *feature, double *score)
{
    return score_by(model, feature, rank_l1, score);
}

static int score_l2(const void *model, const float *feature, double *score)
{
    return score_by(model, feature, rank_l2, score);
}

const struct iso_classifier_ops iso_classifier_nn_l1 = {
    .name = "nn-l1",
    .title = "NN, L1",
    .source = "Cover and Hart 1967",
    .train = train,
    .free = release,
    .score = score_l1,
    .rank = rank_l1,
};

const struct iso_classifier_ops iso_classifier_nn_l2 = {
    .name = "nn-l2",
    .title = "NN, L2",
    .source = "Cover and Hart 1967",
    .train = train,
    .free = release,
    .score = score_l2,
    .rank = rank_l2,
};
