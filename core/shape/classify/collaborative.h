/* Classifiers by collaborative representation: the common part of CRC-RLS and RCR.
 *
 * A feature is coded over all shapes of all classes at once. The share of a class, or of one shape,
 * in that code says how alike they are. The classifiers differ in what a dictionary consists of, in
 * how the codes are computed, and in how the share of a class becomes a score.
 *
 * Features are brought to a common mean and size first (standard.h). How they are compressed, and
 * the penalty lambda of the codes, are chosen for each training set by leave-one-out: each shape is
 * coded over all others (their mean and size are those of all shapes), and the choice is made by
 * the share of shapes that are told to be of their class plus the mean share of a shape's class
 * among its nearest (first tier). */
#ifndef ISO_CORE_SHAPE_CLASSIFY_COLLABORATIVE_H
#define ISO_CORE_SHAPE_CLASSIFY_COLLABORATIVE_H

#include "core/shape/classify/dictionary.h"
#include "core/shape/classify/standard.h"
#include "core/shape/classify/training_set.h"

struct iso_collaborative {
    const struct iso_collaborative_kind *kind;
    struct iso_standard standard;
    struct iso_training_set gallery; /* features as they are coded: standardised */
    int32_t n_parts;
    struct iso_dictionary part[ISO_SHAPE_PARTS_MAX];
    double lambda; /* penalty of the codes */
    bool choosing; /* while lambda is chosen; codes may be found in a simpler way */
};

/* The codes of a feature, one for each dictionary, and the memory to compute them. */
struct iso_code {
    int32_t left;                         /* the shape that is left out: coefficients 0; or -1 */
    const float *y[ISO_SHAPE_PARTS_MAX];  /* [part[k].size], standardised */
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
 * divided by |alpha_i|, which is near 0 for most shapes, so that their order would be arbitrary.
 * The contribution of a negative coefficient always makes the residual longer, because such a shape
 * differs from the mean in the opposite direction: |y|^2 + 2 |alpha_i d_i y| + |alpha_i d_i|^2. */
int iso_collaborative_train(const struct iso_collaborative_kind *kind,
                            const struct iso_labelled *training, void **model)
    __attribute__((warn_unused_result));

/* Frees a model, which must not be NULL. */
void iso_collaborative_free(void *model);
int iso_collaborative_score(const void *model, const float *feature, double *score)
    __attribute__((warn_unused_result));
int iso_collaborative_rank(const void *model, const float *feature, int32_t left, double *distance)
    __attribute__((warn_unused_result));

/* At most so many shapes are left out in turn while lambda is chosen, which bounds the time. */
enum { ISO_COLLABORATIVE_SAMPLE_MAX = 60 };

/* The shapes that are left out, by rising number. Every class gives as many as the others, or all
 * that it has, and they are evenly spread over its shapes: of a class whose poses are sorted, not
 * the first poses alone are taken. A shape that is alone in its class is not taken. If there are
 * more than ISO_COLLABORATIVE_SAMPLE_MAX classes, only the first ones count. *n receives the number
 * of shapes. -ENOMEM. */
int iso_collaborative_sample(const struct iso_training_set *gallery,
                             int32_t sample[ISO_COLLABORATIVE_SAMPLE_MAX], int32_t *n)
    __attribute__((warn_unused_result));

/* Chooses model->lambda for the model's dictionaries (collaborative_choice.c). *quality receives
 * the quality of the chosen one, 0..2: the share of shapes whose class is told plus the mean first
 * tier. It is 0 if no class has two shapes. -ENOMEM. */
int iso_collaborative_choose(struct iso_collaborative *model, double *quality)
    __attribute__((warn_unused_result));

/* A quality must be higher by this to be preferred to one that was tried earlier. */
#define ISO_COLLABORATIVE_GAIN 0.005

/* The memory that a code points into. */
struct iso_code_work {
    float *features; /* y, residual */
    double *numbers;
};

/* Prepares a code for a model; iso_code_done() frees `work`. -ENOMEM. */
int iso_code_init(const struct iso_collaborative *model, struct iso_code_work *work,
                  struct iso_code *code) __attribute__((warn_unused_result));

/* Frees the memory of a code. */
void iso_code_done(struct iso_code_work *work);

/* Codes a feature [gallery.layout.size] that is standardised already. */
void iso_code_find(const struct iso_collaborative *model, const float *feature, int32_t left,
                   const struct iso_code_work *work, struct iso_code *code);

/* The score of each class [n_classes]; -INFINITY for one without shapes besides code->left. */
void iso_code_scores(const struct iso_collaborative *model, const struct iso_code *code,
                     double *score);

/* The distance of each shape [n]; 0 for code->left. */
void iso_code_distances(const struct iso_collaborative *model, const struct iso_code *code,
                        double *distance);

#endif
