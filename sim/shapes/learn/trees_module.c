/* The program's side of the module `trees`. */
#include "sim/shapes/learn/trees_module.h"

static struct iso_module_slot slot = {.name = ISO_TREES_MODULE_NAME,
                                      .size_bytes = sizeof(struct iso_trees_module)};

/* The module's functions. Call this only after iso_tree_load. */
static const struct iso_trees_module *module(void)
{
    return (const struct iso_trees_module *)slot.table;
}

int iso_tree_load(struct iso_fault *fault)
{
    return iso_module_load(&slot, fault);
}

int iso_tree_new(const float *feature, const int32_t *label, int32_t n, int32_t size,
                 struct iso_tree **out)
{
    const int error = iso_tree_load(NULL);
    if (error) {
        return error;
    }
    return module()->create(feature, label, n, size, out);
}

void iso_tree_free(struct iso_tree *tree)
{
    if (tree) {
        module()->release(tree);
    }
}

int iso_tree_tell(const struct iso_tree *tree, const float *feature, int32_t *label)
{
    return module()->tell(tree, feature, label);
}
