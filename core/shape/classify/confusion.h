/* How well classes are told: the confusion matrix and what is read off it (Fawcett, "An
 * introduction to ROC analysis", Pattern Recognition Letters 27, 2006). */
#ifndef ISO_CORE_SHAPE_CLASSIFY_CONFUSION_H
#define ISO_CORE_SHAPE_CLASSIFY_CONFUSION_H

#include <stdint.h>

/* Of one class against all others, or means over classes weighted by their sizes (as Weka's
 * "weighted average", which the dissertation's tables are). */
struct iso_confusion_rates {
    double tp_rate, fp_rate, precision, recall;
    double roc_area; /* chance that a member scores higher than another; a tie is a half */
};

/* Scores as of classifier.h: the class of highest score is told, the first of equals.
 * count[true * n_classes + told] and rates[class] may be NULL. A class that was never told has
 * precision 0; one without members, or that all are members of, has no say in the mean. -EINVAL for
 * labels out of range or scores that are NaN, -ENOMEM. */
int iso_confusion_measure(const double *score, const int32_t *label, int32_t n, int32_t n_classes,
                          int32_t *count, struct iso_confusion_rates *rates,
                          struct iso_confusion_rates *mean) __attribute__((warn_unused_result));

#endif
