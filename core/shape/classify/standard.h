/* Brings the values of features to a common mean and size, which are learnt from a training set.
 *
 * Without this, features that have a large part in common, such as the eigenvalues of Shape-DNA,
 * are nearly parallel: a code over them is then determined by what all shapes share. In steps:
 *
 *  1. The square root or the logarithm compresses parts without negative values. With the square
 *     root, the Euclidean distance of two histograms is their Hellinger distance (Rao, Qüestiió 19,
 *     1995). With the logarithm, eigenvalues that differ by a factor differ by a constant.
 *  2. The mean feature is subtracted, so a code describes how a feature differs from the mean.
 *  3. Each logarithm is divided by its standard deviation. Then each part is divided by its root
 *     mean square over the training set, so that all parts have the same weight.
 *  4. The feature is scaled to a given length. */
#ifndef ISO_CORE_SHAPE_CLASSIFY_STANDARD_H
#define ISO_CORE_SHAPE_CLASSIFY_STANDARD_H

#include "isotherm/classifier.h"

enum iso_compression {
    ISO_COMPRESSION_NONE,
    ISO_COMPRESSION_ROOT,      /* sqrt(x) */
    ISO_COMPRESSION_LOGARITHM, /* ln(1 + x) */
};

struct iso_standard {
    enum iso_compression compression[ISO_SHAPE_PARTS_MAX]; /* of each part */
    struct iso_feature_layout layout;
    double length; /* of a feature afterwards */
    double *mean;  /* [layout.size], of compressed values */
    double *scale; /* [layout.size]; 0 where all shapes are alike */
};

/* Whether there is a part without negative values, which can be compressed. */
bool iso_standard_compressible(const struct iso_labelled *training);

/* Learns mean and scale. Parts with a negative value are not compressed. -ENOMEM. */
int iso_standard_init(struct iso_standard *standard, const struct iso_labelled *training,
                      enum iso_compression compression, double length)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_standard_done(struct iso_standard *standard);

/* Changes a feature [layout.size] in place. A negative value counts as 0 if it has to be
 * compressed. The mean feature becomes 0. */
void iso_standard_apply(const struct iso_standard *standard, float *feature);

#endif
