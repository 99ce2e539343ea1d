/* Classifiers of other libraries, behind the interface of isotherm/classifier.h. Only this
 * folder uses libsvm and OpenCV's ml. A build without one of them lacks its classifier. OpenCV's
 * classifier is in the module `trees` (drivers/base/module.h). */
#ifndef ISO_SIM_SHAPES_LEARN_LEARN_H
#define ISO_SIM_SHAPES_LEARN_LEARN_H

#include "core/base/fault.h"
#include "isotherm/classifier.h"

/* The classifiers of this build; NULL ends the table:
 *
 *   svm            support vectors, linear kernel, one class against one (libsvm: Chang and Lin
 *                  2011)
 *   decision-tree  CART (Breiman et al. 1984) as in OpenCV; the dissertation has C4.5 */
extern const struct iso_classifier_ops *const iso_learn_classifiers[];

/* Searches iso_classifiers, then this table. NULL if no classifier has this name. */
const struct iso_classifier_ops *iso_learn_find(const char *name);

/* Checks that a classifier works on this machine, and loads its module if it has one. -ENOENT:
 * the module is missing (the fault names the package). -EBADMSG: the module cannot be used. */
int iso_learn_load(const struct iso_classifier_ops *ops, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
