/* Classifiers of other libraries, behind the interface of core/shape/classifier.h: the one place
 * that knows libsvm and OpenCV's ml. A build without one of them lacks its classifier. */
#ifndef ISO_DRIVERS_LEARN_LEARN_H
#define ISO_DRIVERS_LEARN_LEARN_H

#include "core/shape/classifier.h"

/* Of this build; the table ends with NULL:
 *
 *   svm            support vectors, linear kernel, one class against one (libsvm: Chang and Lin
 *                  2011)
 *   decision-tree  CART (Breiman et al. 1984) as in OpenCV; the dissertation has C4.5 */
extern const struct iso_classifier_ops *const iso_learn_classifiers[];

/* Looks in iso_classifiers, then here. NULL if there is none of that name. */
const struct iso_classifier_ops *iso_learn_find(const char *name);

#endif
