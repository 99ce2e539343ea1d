/* The part of the module `tpm2` that is linked into the program. */
#include "drivers/counter/tpm2_module.h"

#include <errno.h>
#include <stdlib.h>

static struct iso_module_slot slot = {.name = ISO_TPM2_MODULE_NAME,
                                      .size_bytes = sizeof(struct iso_tpm2_module)};

int iso_tpm2_counter_load(struct iso_fault *fault)
{
    if (!slot.tried) {
        (void)setenv("TSS2_LOG", "all+NONE", 0);
    }
    return iso_module_load(&slot, fault);
}

int iso_tpm2_counter_open(const char *tcti, uint32_t index, struct iso_counter *out,
                          struct iso_fault *fault)
{
    const int error = iso_tpm2_counter_load(fault);
    return error ? error
                 : ((const struct iso_tpm2_module *)slot.table)->open(tcti, index, out, fault);
}

int iso_tpm2_index_parse(const char *text, uint32_t *out, struct iso_fault *fault)
{
    char *end = NULL;
    errno = 0;
    const unsigned long index = strtoul(text, &end, 0);
    if (errno || end == text || *end || index < ISO_TPM2_INDEX_FIRST ||
        index > ISO_TPM2_INDEX_LAST) {
        return iso_fault_set_code(fault, ISO_FAULT_CONFIG_WRONG, -EINVAL,
                                  "'%s' is not an index of the owner of a TPM: %#x to %#x", text,
                                  (unsigned)ISO_TPM2_INDEX_FIRST, (unsigned)ISO_TPM2_INDEX_LAST);
    }
    *out = (uint32_t)index;
    return 0;
}
