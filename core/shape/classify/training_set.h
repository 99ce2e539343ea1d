/* The features that a classifier learned from, and their classes. */
#ifndef ISO_CORE_SHAPE_CLASSIFY_TRAINING_SET_H
#define ISO_CORE_SHAPE_CLASSIFY_TRAINING_SET_H

#include "isotherm/classifier.h"

struct iso_training_set {
    struct iso_feature_layout layout;
    int32_t n, n_classes;
    float *feature; /* [n][layout.size] */
    int32_t *label; /* [n] */
};

/* Copies the features and labels. -ENOMEM. */
int iso_training_set_init(struct iso_training_set *gallery, const struct iso_labelled *training)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_training_set_done(struct iso_training_set *gallery);

/* Makes scores of distances: score[c] is minus the lowest of the distances [n] to the features of
 * class c, or -INFINITY if the class has none. */
void iso_training_set_score(const struct iso_training_set *gallery, const double *distance,
                            double *score);

/* The operations of isotherm/classifier.h that this library has. */
extern const struct iso_classifier_ops iso_classifier_nn_l1, iso_classifier_nn_l2,
    iso_classifier_crc_rls, iso_classifier_rcr, iso_classifier_naive_bayes, iso_classifier_nn;

#endif
