/* The table that the module `tpm2` exports. */
#include "drivers/counter/tpm2_module.h"

extern const struct iso_tpm2_module iso_module;

ISO_MODULE_EXPORT const struct iso_tpm2_module iso_module = {
    .module = ISO_MODULE(ISO_TPM2_MODULE_NAME, struct iso_tpm2_module),
    .open = iso_tpm2_counter_open,
};
