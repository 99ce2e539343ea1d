/* Classifiers by collaborative representation: the common part of CRC-RLS and RCR.
 *
 * A feature is coded over all shapes of all classes at once. The share of a class, or of one shape,
 * in that code says how alike they are. The classifiers differ in what a dictionary consists of, in
 * how the codes are computed, and in how the share of a class becomes a score. */
#ifndef ISO_CORE_SHAPE_CLASSIFY_COLLABORATIVE_H
#define ISO_CORE_SHAPE_CLASSIFY_COLLABORATIVE_H

#include "core/shape/classify/dictionary.h"
#include "core/shape/classify/training_set.h"

struct iso_collaborative {
    const struct iso_collaborative_kind *kind;
    struct iso_training_set gallery; /* features as they are coded: of unit length */
    int32_t n_parts;
    struct iso_dictionary part[ISO_SHAPE_PARTS_MAX];
};

/* The codes of a feature, one for each dictionary, and the memory to compute them. */
struct iso_code {
    int32_t left;                         /* the shape that is left out: coefficients 0; or -1 */
    const float *y[ISO_SHAPE_PARTS_MAX];  /* [part[k].size], of unit length */
    double *product[ISO_SHAPE_PARTS_MAX]; /* [n]: D_k y_k */
    double *alpha[ISO_SHAPE_PARTS_MAX];   /* [n] */
    double weight[ISO_SHAPE_PARTS_MAX];   /* of each part in scores and distances, above 0 */
    double *mean, *right, *scratch;       /* [n], [n], [2 n], for find() */
    float *residual;                      /* [size], for iso_code_residual */
};

struct iso_collaborative_kind {
    bool joined; /* one dictionary, of whole features; otherwise one of each part */
    /* Finds alpha and weight, given y, product and left. */
    void (*find)(const struct iso_collaborative *model, struct iso_code *code);
    /* The score of a class that has at least one shape. */
    double (*score)(const struct iso_collaborative *model, const struct iso_code *code,
                    int32_t class);
};

/* |y_k - D_k a_k|^2 over the shapes of one class. */
double iso_code_residual(const struct iso_collaborative *model, const struct iso_code *code,
                         int32_t k, int32_t class);

/* The operations of isotherm/classifier.h; the model is an iso_collaborative. The ranking treats
 * each shape as a class of its own. The distance of a shape is the residual of y after the
 * contribution of that shape is subtracted, averaged over the parts by their weights. It is not
 * divided by |alpha_i|, which is near 0 for most shapes, so that their order would be arbitrary. */
int iso_collaborative_train(const struct iso_collaborative_kind *kind,
                            const struct iso_labelled *training, void **model)
    __attribute__((warn_unused_result));

/* Frees a model, which must not be NULL. */
void iso_collaborative_free(void *model);
int iso_collaborative_score(const void *model, const float *feature, double *score)
    __attribute__((warn_unused_result));
int iso_collaborative_rank(const void *model, const float *feature, int32_t left, double *distance)
    __attribute__((warn_unused_result));

#endif
