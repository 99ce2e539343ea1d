/* Classifiers of other libraries, behind the interface of isotherm/classifier.h: the one
 * place that knows libsvm and OpenCV's ml. A build without one of them lacks its classifier; that
 * of OpenCV is in the module `trees` (drivers/base/module.h). */
#ifndef ISO_SIM_SHAPES_LEARN_LEARN_H
#define ISO_SIM_SHAPES_LEARN_LEARN_H

#include "core/base/fault.h"
#include "isotherm/classifier.h"

/* Of this build; the table ends with NULL:
 *
 *   svm            support vectors, linear kernel, one class against one (libsvm: Chang and Lin
 *                  2011)
 *   decision-tree  CART (Breiman et al. 1984) as in OpenCV; the dissertation has C4.5 */
extern const struct iso_classifier_ops *const iso_learn_classifiers[];

/* Looks in iso_classifiers, then here. NULL if there is none of that name. */
const struct iso_classifier_ops *iso_learn_find(const char *name);

/* Whether a classifier can be used on this machine: loads its module, if it has one. -ENOENT the
 * module is missing (the fault names the package), -EBADMSG it cannot be used. */
int iso_learn_load(const struct iso_classifier_ops *ops, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
