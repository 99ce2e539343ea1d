/* The classifiers of drivers/learn, each in a source of its own. */
#ifndef ISO_DRIVERS_LEARN_OPS_H
#define ISO_DRIVERS_LEARN_OPS_H

#include "core/shape/classifier.h"

extern const struct iso_classifier_ops iso_learn_svm, iso_learn_decision_tree;

#endif
