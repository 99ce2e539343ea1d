/* Stratified cross-validation (classifier.h). */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "isotherm/classifier.h"

static uint32_t next_random(uint64_t *state, uint32_t below)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((*state >> 33) % below);
}

/* Distributes the members of one class after another over the folds, each class in random order. */
static void deal(const struct iso_labelled *all, int32_t folds, uint64_t seed, int32_t *order,
                 int32_t *fold)
{
    uint64_t state = seed * 2862933555777941757u + 3037000493u;
    int32_t next = 0;
    for (int32_t c = 0; c < all->n_classes; c++) {
        int32_t n = 0;
        for (int32_t i = 0; i < all->n; i++) {
            if (all->label[i] == c) {
                order[n++] = i;
            }
        }
        for (int32_t i = n; i > 0; i--) { /* Fisher and Yates */
            const int32_t drawn = (int32_t)next_random(&state, (uint32_t)i);
            fold[order[drawn]] = next++ % folds;
            order[drawn] = order[i - 1];
        }
    }
}

/* Learns from all folds except one, and scores the members of that one. */
static int validate_fold(const struct iso_classifier_ops *ops, const struct iso_labelled *all,
                         const int32_t *fold, int32_t which, float *feature, int32_t *label,
                         double *score)
{
    const size_t size = (size_t)all->layout->size;
    struct iso_labelled rest = *all;
    struct iso_classifier *classifier = NULL;
    rest.n = 0;
    for (int32_t i = 0; i < all->n; i++) {
        if (fold[i] != which) {
            memcpy(&feature[(size_t)rest.n * size], &all->feature[(size_t)i * size],
                   size * sizeof *feature);
            label[rest.n++] = all->label[i];
        }
    }
    rest.feature = feature;
    rest.label = label;
    int error = iso_classifier_new(ops, &rest, &classifier);
    for (int32_t i = 0; !error && i < all->n; i++) {
        if (fold[i] == which) {
            error = iso_classifier_score(classifier, &all->feature[(size_t)i * size],
                                         &score[(size_t)i * (size_t)all->n_classes]);
        }
    }
    iso_classifier_free(classifier);
    return error;
}

int iso_cross_validate(const struct iso_classifier_ops *ops, const struct iso_labelled *all,
                       int32_t folds, uint64_t seed, double *score)
{
    if (all->n < 2 || folds < 2 || folds > all->n) {
        return -EINVAL;
    }
    size_t n = (size_t)all->n, scores = n * (size_t)all->n_classes;
    int32_t *fold = calloc(n, sizeof *fold), *order = calloc(n, sizeof *order);
    int32_t *label = calloc(n, sizeof *label);
    float *feature = calloc(n * (size_t)all->layout->size, sizeof *feature);
    double *made = calloc(scores, sizeof *made);
    int error = fold && order && label && feature && made ? 0 : -ENOMEM;
    if (!error) {
        deal(all, folds, seed, order, fold);
    }
    for (int32_t f = 0; !error && f < folds; f++) {
        error = validate_fold(ops, all, fold, f, feature, label, made);
    }
    if (!error) {
        memcpy(score, made, scores * sizeof *score);
    }
    free(fold);
    free(order);
    free(label);
    free(feature);
    free(made);
    return error;
}
