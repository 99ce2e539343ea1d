/* OpenCV's decision trees with an interface in plain C. Only the code behind this interface uses
 * OpenCV's ml; it lets no C++ exception out. The code is in the module `trees`
 * (drivers/base/module.h). */
#ifndef ISO_SIM_SHAPES_LEARN_TREE_H
#define ISO_SIM_SHAPES_LEARN_TREE_H

#include <stdint.h>

#include "core/base/fault.h"

struct iso_tree;

/* Loads the module if it is not loaded yet. The errors of iso_module_load. */
int iso_tree_load(struct iso_fault *fault) __attribute__((warn_unused_result));

/* Learns from n features of `size` values with labels >= 0. -EINVAL for input that OpenCV
 * refuses, -ENOMEM, the errors of iso_tree_load. */
int iso_tree_new(const float *feature, const int32_t *label, int32_t n, int32_t size,
                 struct iso_tree **out) __attribute__((warn_unused_result));

/* Frees it. NULL is accepted. */
void iso_tree_free(struct iso_tree *tree);

/* Sets the label that the tree predicts. -EDOM if OpenCV refuses the feature, -ENOMEM. */
int iso_tree_tell(const struct iso_tree *tree, const float *feature, int32_t *label)
    __attribute__((warn_unused_result));

#endif
