/* The functions that the module `trees` exports. */
#include "sim/shapes/learn/trees_module.h"

extern const struct iso_trees_module iso_module;

ISO_MODULE_EXPORT const struct iso_trees_module iso_module = {
    .module = ISO_MODULE(ISO_TREES_MODULE_NAME, struct iso_trees_module),
    .create = iso_tree_new,
    .release = iso_tree_free,
    .tell = iso_tree_tell,
};
