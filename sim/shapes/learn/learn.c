#include "sim/shapes/learn/learn.h"

#include <stddef.h>
#include <string.h>

#include "sim/shapes/learn/ops.h"
#ifdef ISOTHERM_OPENCV_ML
#include "sim/shapes/learn/tree.h"
#endif

const struct iso_classifier_ops *const iso_learn_classifiers[] = {
#ifdef ISOTHERM_LIBSVM
    &iso_learn_svm,
#endif
#ifdef ISOTHERM_OPENCV_ML
    &iso_learn_decision_tree,
#endif
    NULL,
};

static const struct iso_classifier_ops *find(const struct iso_classifier_ops *const *table,
                                             const char *name)
{
    while (*table && strcmp((*table)->name, name) != 0) {
        table++;
    }
    return *table;
}

const struct iso_classifier_ops *iso_learn_find(const char *name)
{
    const struct iso_classifier_ops *found = find(iso_classifiers, name);
    return found ? found : find(iso_learn_classifiers, name);
}

int iso_learn_load(const struct iso_classifier_ops *ops, struct iso_fault *fault)
{
#ifdef ISOTHERM_OPENCV_ML
    if (ops == &iso_learn_decision_tree) {
        return iso_tree_load(fault);
    }
#endif
    (void)ops;
    (void)fault;
    return 0;
}
