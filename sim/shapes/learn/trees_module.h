/* The module `trees`: the functions of tree.h, in a separate shared object
 * (drivers/base/module.h). Programs call these functions as usual; trees_module.c forwards the
 * calls. */
#ifndef ISO_SIM_SHAPES_LEARN_TREES_MODULE_H
#define ISO_SIM_SHAPES_LEARN_TREES_MODULE_H

#include "drivers/base/module.h"
#include "sim/shapes/learn/tree.h"

#define ISO_TREES_MODULE_NAME "trees"

struct iso_trees_module {
    struct iso_module module;
    __typeof__(iso_tree_new) *create;
    __typeof__(iso_tree_free) *release;
    __typeof__(iso_tree_tell) *tell;
};

#endif
