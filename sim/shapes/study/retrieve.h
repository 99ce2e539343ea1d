/* Queries against a corpus: distances, and the quality of retrieval and classification.
 *
 * A query is never compared with itself. The undistorted original of a distorted query is left
 * out as well, because the similarity of a shape to itself is no result. */
#ifndef SIM_SHAPES_STUDY_RETRIEVE_H
#define SIM_SHAPES_STUDY_RETRIEVE_H

#include "core/shape/classify/confusion.h"
#include "core/shape/classify/retrieval.h"
#include "isotherm/classifier.h"
#include "sim/shapes/study/bank.h"

/* Features of a corpus, and of queries that were described separately. */
struct sim_features {
    struct iso_shape_coder *coder; /* learned from the corpus */
    int index;                     /* of the method in both banks */
    const struct iso_feature_layout *layout;
    const struct sim_bank *items, *queries; /* equal if the items are the queries */
    const struct sim_shape_manifest *manifest;
    float *item, *query; /* [n][layout->size] */
    int32_t *item_class, *query_class, *item_wider, *query_wider;
    int32_t *own; /* [queries->n]: the item that equals the query or is its original */
};

struct sim_features_options {
    const struct iso_shape_method *method;
    int index;    /* of the method in both banks */
    int32_t size; /* number of features, see iso_shape_coder_new; 0: the method's own */
    uint64_t seed;
};

/* Learns from a bank that describes all rows of the manifest in their order. Bank and manifest
 * are borrowed. The items are the queries. Errors of iso_shape_coder_new and iso_shape_code,
 * -ENOMEM. */
int sim_features_new(const struct sim_shape_manifest *manifest, const struct sim_bank *items,
                     const struct sim_features_options *options, struct sim_features **out)
    __attribute__((warn_unused_result));

/* Sets other queries, which are borrowed: rows of the same manifest described by the same
 * methods, or the items again. On failure the queries stay unchanged: -EINVAL, -ENOMEM. */
int sim_features_ask(struct sim_features *features, const struct sim_bank *queries)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_features_free(struct sim_features *features);

/* Computes distance[query][item], 0 for the query's own item, by a classifier that learns from all
 * items. -ENOSYS for a classifier that cannot rank; errors of the classifier; -ENOMEM. */
int sim_features_rank(const struct sim_features *features,
                      const struct iso_classifier_ops *classifier, int threads, double *distance)
    __attribute__((warn_unused_result));

/* Retrieval measures of a matrix of distances. -ENOMEM. */
int sim_features_measure(const struct sim_features *features, const double *distance,
                         struct iso_retrieval *out) __attribute__((warn_unused_result));

/* Measures the quality of classification, as means over classes. If the queries are the items, they
 * are tested by 10-fold cross-validation (with fewer than 10 items, one fold for each). Otherwise
 * each query has its own classifier, which learns from all items except the query's own.
 * count[true * n_classes + predicted] may be NULL. Errors of the classifier, -ENOMEM. */
int sim_features_classify(const struct sim_features *features,
                          const struct iso_classifier_ops *classifier, uint64_t seed, int threads,
                          int32_t *count, struct iso_confusion_rates *out)
    __attribute__((warn_unused_result));

#endif
