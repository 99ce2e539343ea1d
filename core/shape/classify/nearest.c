/* Nearest neighbour (Cover and Hart 1967): the class of the closest feature. */
#include <errno.h>
#include <stdlib.h>

#include "core/shape/classify/feature_distance.h"
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

static int rank_by(const struct iso_training_set *g, enum iso_norm norm, const float *feature,
                   int32_t left, double *distance)
{
    return iso_feature_distances(&g->layout, norm, feature, g->feature, g->n, left, distance);
}

static int rank_l1(const void *model, const float *feature, int32_t left, double *distance)
{
    return rank_by(model, ISO_NORM_L1, feature, left, distance);
}

static int rank_l2(const void *model, const float *feature, int32_t left, double *distance)
{
    return rank_by(model, ISO_NORM_L2, feature, left, distance);
}

static int rank_own(const void *model, const float *feature, int32_t left, double *distance)
{
    const struct iso_training_set *g = model;
    return rank_by(g, g->layout.norm, feature, left, distance);
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

static int score_own(const void *model, const float *feature, double *score)
{
    return score_by(model, feature, rank_own, score);
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

const struct iso_classifier_ops iso_classifier_nn = {
    .name = "nn",
    .title = "NN, the method's norm",
    .source = "Cover and Hart 1967",
    .train = train,
    .free = release,
    .score = score_own,
    .rank = rank_own,
};
