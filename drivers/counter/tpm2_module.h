/* The module `tpm2` is a shared object of its own (drivers/base/module.h). Its table has only
 * iso_tpm2_counter_open of tpm2_counter.h; the counter that this opens brings the other
 * operations. */
#ifndef ISO_DRIVERS_COUNTER_TPM2_MODULE_H
#define ISO_DRIVERS_COUNTER_TPM2_MODULE_H

#include "drivers/base/module.h"
#include "drivers/counter/tpm2_counter.h"

#define ISO_TPM2_MODULE_NAME "tpm2"

struct iso_tpm2_module {
    struct iso_module module;
    __typeof__(iso_tpm2_counter_open) *open;
};

#endif
