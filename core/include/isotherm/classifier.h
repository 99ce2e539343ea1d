/* Classifiers of feature vectors behind one interface.
 *
 * Each learns from labelled features and gives a score for every class. Those that also measure how
 * far a feature is from each one it learnt from (nearest neighbour, CRC-RLS, RCR) rank a gallery:
 * that ranking never looks at labels. Classifiers of other libraries: sim/shapes/learn/. */
#ifndef ISOTHERM_CLASSIFIER_H
#define ISOTHERM_CLASSIFIER_H

#include "isotherm/shape_method.h"

/* Features with their classes; borrowed. */
struct iso_labelled {
    const struct iso_feature_layout *layout;
    int32_t n, n_classes;
    const float *feature; /* [n][layout->size], finite */
    const int32_t *label; /* [n], 0..n_classes - 1 */
};

/* A kind of classifier. Models keep copies of what they need. */
struct iso_classifier_ops {
    const char *name;   /* "crc-rls" */
    const char *title;  /* "CRC-RLS" */
    const char *source; /* author, year */

    /* REQUIRED. Learns. -EINVAL if there is too little to learn from, -EDOM if a system is
     * singular, -ENOMEM. */
    int (*train)(const struct iso_labelled *training, void **model);
    void (*free)(void *model);

    /* REQUIRED. A score for each class; higher is more likely. A class without examples has
     * -INFINITY. Thread-safe. -EDOM, -ENOMEM. */
    int (*score)(const void *model, const float *feature, double *score);

    /* OPTIONAL. distance[i] is the distance from the feature to the i-th learned one; lower is more
     * alike. `left` is a learned feature that is left out as if it had never been learned, or -1;
     * its own distance is then 0. Thread-safe. -EDOM, -ENOMEM. */
    int (*rank)(const void *model, const float *feature, int32_t left, double *distance);
};

/* Those of this library; the table ends with NULL:
 *
 *   nn-l1, nn-l2   nearest neighbour
 *   crc-rls        collaborative representation, regularised least squares
 *   rcr            relaxed collaborative representation, weights of the parts optimised
 *   naive-bayes    independent normal densities */
extern const struct iso_classifier_ops *const iso_classifiers[];

/* Calls the operations, and checks the arguments first. */
struct iso_classifier;

/* -EINVAL for labels out of range, features that are not finite, n < 1 or fewer than 2 classes. */
int iso_classifier_new(const struct iso_classifier_ops *ops, const struct iso_labelled *training,
                       struct iso_classifier **out) __attribute__((warn_unused_result));
void iso_classifier_free(struct iso_classifier *classifier);

int iso_classifier_score(const struct iso_classifier *classifier, const float *feature,
                         double *score) __attribute__((warn_unused_result));

/* -ENOSYS for a kind that cannot rank. */
int iso_classifier_rank(const struct iso_classifier *classifier, const float *feature, int32_t left,
                        double *distance) __attribute__((warn_unused_result));

/* Scores every feature by a classifier that has not learned from it: stratified cross-validation
 * (Kohavi 1995). `folds` is 2..n; n is leave-one-out. score is [n][n_classes]. The members of the
 * classes are distributed over the folds in an order drawn from `seed`. -EINVAL, errors of the
 * classifier. */
int iso_cross_validate(const struct iso_classifier_ops *ops, const struct iso_labelled *all,
                       int32_t folds, uint64_t seed, double *score)
    __attribute__((warn_unused_result));

#endif
