/* The classifiers of sim/shapes/learn; each has its own source. */
#ifndef ISO_SIM_SHAPES_LEARN_OPS_H
#define ISO_SIM_SHAPES_LEARN_OPS_H

#include "isotherm/classifier.h"

extern const struct iso_classifier_ops iso_learn_svm, iso_learn_decision_tree;

#endif
