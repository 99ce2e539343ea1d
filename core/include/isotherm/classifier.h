/** @file
 * Classifiers of feature vectors behind one interface.
 *
 * Each learns from labelled features and gives a score for every class. Some also measure how far a
 * feature is from each training feature (nearest neighbour, CRC-RLS, RCR). These can rank a
 * gallery, and the ranking uses no labels, except that CRC-RLS and RCR choose their parameters with
 * them. */
#ifndef ISOTHERM_CLASSIFIER_H
#define ISOTHERM_CLASSIFIER_H

#include "isotherm/shape_method.h"

/** Features with their classes. The arrays belong to the caller. */
struct iso_labelled {
    const struct iso_feature_layout *layout; /**< The layout of the features. */
    int32_t n;                               /**< How many features. */
    int32_t n_classes;                       /**< How many classes. */
    const float *feature;                    /**< [n][layout->size], finite. */
    const int32_t *label;                    /**< [n]: class of each, 0..n_classes - 1. */
};

/** A kind of classifier. Its models keep copies of the training data that they need. */
struct iso_classifier_ops {
    const char *name;   /**< As on a command line: "crc-rls". */
    const char *title;  /**< As in a table: "CRC-RLS". */
    const char *source; /**< Author, year. */

    /** REQUIRED. Learns. -EINVAL if there is too little to learn from, -EDOM if a system is
     * singular, -ENOMEM. */
    int (*train)(const struct iso_labelled *training, void **model);
    /** REQUIRED. Frees a model. */
    void (*free)(void *model);

    /** REQUIRED. A score for each class, higher is more likely; a class that nothing was learnt of
     * has -INFINITY. Thread-safe. -EDOM, -ENOMEM. */
    int (*score)(const void *model, const float *feature, double *score);

    /** OPTIONAL. Sets distance[i] to the distance of the feature from training feature i; lower is
     * more alike. `left` is the index of a training feature that is left out, or -1; its distance
     * is 0, and it takes no part in the distances of others. (What a model knows of all training
     * features together, such as their mean, may include it.) Thread-safe. -EDOM, -ENOMEM;
     * -EINVAL for features that the norm is not for. */
    int (*rank)(const void *model, const float *feature, int32_t left, double *distance);
};

/** The classifiers of this library; the table ends with NULL:
 *
 *     nn-l1, nn-l2   nearest neighbour
 *     crc-rls        collaborative representation, regularised least squares
 *     rcr            relaxed collaborative representation, weights of the parts optimised
 *                    (crc-rls and rcr subtract the mean feature and give all parts the same size.
 *                    By leave-one-out they choose the penalty of the codes from 0.1, 0.5, 2 and 8,
 *                    and how they compress parts without negative values: by the square root, by
 *                    the logarithm, or not at all)
 *     naive-bayes    independent normal densities
 *     nn             nearest neighbour by the norm of the layout, which is that of the method
 */
extern const struct iso_classifier_ops *const iso_classifiers[];

/** A trained classifier. */
struct iso_classifier;

/** Trains a classifier.
 *
 * @param ops       The kind: one of iso_classifiers, or one of the caller's.
 * @param training  What it learns from.
 * @param out       Receives the classifier; free it with iso_classifier_free().
 * @return 0; -EINVAL for labels out of range, features that are not finite, n < 1 or fewer than 2
 *         classes; errors of the kind. */
int iso_classifier_new(const struct iso_classifier_ops *ops, const struct iso_labelled *training,
                       struct iso_classifier **out) __attribute__((warn_unused_result));

/** Frees a classifier.
 *
 * @param classifier  The classifier, or NULL. */
void iso_classifier_free(struct iso_classifier *classifier);

/** How likely a feature is of each class. Thread-safe.
 *
 * @param classifier  The classifier.
 * @param feature     [layout->size]: the feature, finite.
 * @param score       [n_classes]: receives the scores; higher is more likely, -INFINITY for a class
 *                    that nothing was learnt of.
 * @return 0; errors of the kind. */
int iso_classifier_score(const struct iso_classifier *classifier, const float *feature,
                         double *score) __attribute__((warn_unused_result));

/** How far a feature is from each training feature. Thread-safe.
 *
 * @param classifier  The classifier.
 * @param feature     [layout->size]: the feature, finite.
 * @param left        Index of the training feature that the ranking leaves out; -1: it uses all.
 * @param distance    [n]: receives the distances; lower is more alike. It is 0 for the feature that
 *                    is left out.
 * @return 0; -ENOSYS for a kind that cannot rank; errors of the kind. */
int iso_classifier_rank(const struct iso_classifier *classifier, const float *feature, int32_t left,
                        double *distance) __attribute__((warn_unused_result));

/** Scores of every feature by a classifier that has not learnt from it: stratified cross-validation
 * (Kohavi 1995). Classes are dealt to the folds in an order drawn from the seed.
 *
 * @param ops    The kind of classifier.
 * @param all    All features with their classes.
 * @param folds  2..n; n is leave-one-out.
 * @param seed   Draws the order.
 * @param score  [n][n_classes]: receives the scores.
 * @return 0; -EINVAL; errors of the kind. */
int iso_cross_validate(const struct iso_classifier_ops *ops, const struct iso_labelled *all,
                       int32_t folds, uint64_t seed, double *score)
    __attribute__((warn_unused_result));

#endif
