#include "firmware/recognise/method/method.h"

#include <errno.h>

static const struct iso_method_ops *const methods[ISO_METHODS] = {
#define METHOD(name, about) [ISO_METHOD_##name] = &iso_method_##name##_ops,
#include "firmware/recognise/method/methods.def"
#undef METHOD
};

const struct iso_method_ops *iso_method_at(enum iso_method method)
{
    return methods[method];
}

int iso_method_check_algorithm(const struct iso_method_setup *setup, uint32_t algorithm,
                               struct iso_fault *fault)
{
    if (algorithm == setup->algorithm) {
        return 0;
    }
    return iso_fault_set_code(fault, ISO_FAULT_MODEL_MISFIT, -EINVAL,
                              "%s: made with another head model or other options (%08x, not %08x)",
                              setup->data_path, algorithm, setup->algorithm);
}
