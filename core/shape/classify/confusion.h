/* How well a classifier works: the confusion matrix and the rates that follow from it (Fawcett, "An
 * introduction to ROC analysis", Pattern Recognition Letters 27, 2006). */
#ifndef ISO_CORE_SHAPE_CLASSIFY_CONFUSION_H
#define ISO_CORE_SHAPE_CLASSIFY_CONFUSION_H

#include <stdint.h>

/* The rates of one class against all others, or the means over classes weighted by their sizes
 * (like the "weighted average" of Weka, which the tables of the dissertation have). */
struct iso_confusion_rates {
    double tp_rate, fp_rate, precision, recall;
    double roc_area; /* chance that a member scores higher than a non-member; a tie is a half */
};

/* Measures scores [n][n_classes] as of classifier.h against the true classes label [n]. The
 * predicted class is the one with the highest score, the first of several equal ones. count[true *
 * n_classes + predicted] receives the confusion matrix and rates [n_classes] the rates of each
 * class; both may be NULL. A class that was never predicted has precision 0. A class without
 * members, or with all of them, does not count in the mean. -EINVAL for labels out of range or
 * scores that are NaN, -ENOMEM. */
int iso_confusion_measure(const double *score, const int32_t *label, int32_t n, int32_t n_classes,
                          int32_t *count, struct iso_confusion_rates *rates,
                          struct iso_confusion_rates *mean) __attribute__((warn_unused_result));

#endif
