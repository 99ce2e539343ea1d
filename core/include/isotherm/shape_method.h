/* Descriptors of non-rigid shapes by name: the table that an evaluation runs through.
 *
 * A shape becomes a feature vector in two steps, since some methods learn from a corpus (without
 * labels) what a vector means:
 *
 *     shape --describe--> description --code--> feature          (coder: learnt from descriptions)
 *
 * All features of one coder have one layout. Its parts are what RCR codes apart (classifier.h);
 * other classifiers see one vector. */
#ifndef ISOTHERM_SHAPE_METHOD_H
#define ISOTHERM_SHAPE_METHOD_H

#include <stdbool.h>

#include "isotherm/shape.h"

enum {
    ISO_SHAPE_PARTS_MAX = 8,
    ISO_SHAPE_BAGS_MAX = ISO_CHANNELS,
};

/* The description of a shape. All sizes except n_points are the method's, the same for all shapes.
 */
struct iso_shape_description {
    /* Of methods with bags: a row of n_values for each vertex, in each bag (colour channel). */
    int32_t n_bags, n_points, n_values;
    float *local;  /* [n_bags][n_points][n_values] */
    float *weight; /* [n_points]: share of the area, sum 1 */
    /* Of the shape as a whole: parts one after another. */
    int32_t n_parts;
    int32_t part_size[ISO_SHAPE_PARTS_MAX];
    float *whole; /* [sum of part_size] */
};

enum iso_shape_coding {
    ISO_CODING_PLAIN,   /* the parts as they are */
    ISO_CODING_REDUCED, /* the first part by its principal components, others as they are */
    ISO_CODING_BAGS,    /* words of a vocabulary for each bag, then the parts */
};

enum iso_norm {
    ISO_NORM_L1,
    ISO_NORM_L2,
};

struct iso_shape_method {
    const char *name;   /* as on a command line: "cp-hk" */
    const char *title;  /* as in a table: "CP-HK" */
    const char *source; /* author, year, section */
    bool colour;        /* describe() is -ENODATA for a shape without colours */
    enum iso_shape_coding coding;
    int32_t size;           /* default: principal components, or words of each vocabulary; or 0 */
    enum iso_norm norm;     /* the norm that suits its nearest neighbour best */
    const char *classifier; /* what the dissertation classifies it by: a name of classifier.h */
    /* Use iso_shape_describe. */
    int (*describe)(const struct iso_shape *shape, struct iso_shape_description *out);
};

/* All methods; the table ends with NULL:
 *
 *   shape-dna     15 normalised eigenvalues
 *   td            temperature distribution: histogram of the heat mean signature
 *   cp-td         heat from critical points: histograms at 100 times, normalised eigenvalues
 *   srcp-td       the same, reduced to 64 principal components
 *   srcp-td-one   the same from one point, the minimum of the heat mean signature
 *   cp-hk         scale-invariant heat from critical points: 6 histograms, how many points there
 *                 are, normalised eigenvalues
 *   cp-hk-plain   cp-hk without the eigenvalues
 *   shape-google  bag of features over SI-HKS
 *   w-hks1        bags of features over scale-invariant weighted signatures of three channels
 *   w-hks2        the same and a histogram of colours
 *   si-hk-colour  bag of features over scale-invariant signatures and a histogram of colours (A2 of
 *                 SHREC'13, what chapter 5 compares itself with) */
extern const struct iso_shape_method *const iso_shape_methods[];

/* NULL if there is none of that name. */
const struct iso_shape_method *iso_shape_method_find(const char *name);

/* Describes a shape. -ENODATA if the method needs colours and there are none, -ENOMEM.
 * Thread-safe. */
int iso_shape_describe(const struct iso_shape_method *method, const struct iso_shape *shape,
                       struct iso_shape_description **out) __attribute__((warn_unused_result));
void iso_shape_description_free(struct iso_shape_description *description);

/* How a feature vector is laid out. */
struct iso_feature_layout {
    int32_t size; /* values of a feature */
    int32_t n_parts;
    int32_t part_size[ISO_SHAPE_PARTS_MAX]; /* they follow each other; their sum is size */
};

struct iso_shape_coder;

/* Learns from the descriptions of a corpus by one method. A `size` of 0 stands for the method's
 * default (with ISO_CODING_REDUCED it cannot be above n, and is reduced to that); `seed` starts the
 * vocabularies. -EINVAL for descriptions of different sizes or n < 1, -ENOMEM, -EDOM if principal
 * components cannot be found. */
int iso_shape_coder_new(const struct iso_shape_method *method,
                        const struct iso_shape_description *const *training, int32_t n,
                        int32_t size, uint64_t seed, struct iso_shape_coder **out)
    __attribute__((warn_unused_result));
void iso_shape_coder_free(struct iso_shape_coder *coder);

const struct iso_feature_layout *iso_shape_coder_layout(const struct iso_shape_coder *coder);

/* The feature of one description: layout->size values. -EINVAL for a description of other sizes
 * than those learnt from, -ENOMEM. Thread-safe. */
int iso_shape_code(const struct iso_shape_coder *coder,
                   const struct iso_shape_description *description, float *feature)
    __attribute__((warn_unused_result));

#endif
