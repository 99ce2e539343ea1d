/* A counter in the non-volatile memory of a TPM 2.0: an NV index of the type TPM2_NT_COUNTER in the
 * owner's hierarchy (TPM 2.0 Library, part 1, "NV counter index").
 *
 * The index has an empty password for reading and counting: everybody who may use the TPM can raise
 * the counter, and nobody can undo it. Creating or deleting the index takes the owner's password,
 * which is empty unless somebody has set one. If one is set, the index must be created by hand
 * (isothermd(8)). A new counter of a TPM begins above the largest value that any of its counters
 * ever had, so the number also rises if the counter is deleted and made again. It is not an
 * "orderly" counter, whose value jumps when power is lost.
 *
 * The functions are in the module `tpm2` (drivers/base/module.h), which links the TPM software
 * stack. */
#ifndef ISO_DRIVERS_COUNTER_TPM2_COUNTER_H
#define ISO_DRIVERS_COUNTER_TPM2_COUNTER_H

#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/counter/counter.h"

/* The indices that the owner of the TPM may use. */
enum { ISO_TPM2_INDEX_FIRST = 0x01800000, ISO_TPM2_INDEX_LAST = 0x01bfffff };

/* Loads the module, unless it is loaded. Must be called before threads are started, because it sets
 * a variable of the environment, so that the software stack writes no lines of its own. The errors
 * of iso_module_load. */
int iso_tpm2_counter_load(struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens a TPM. tcti: how it is reached, "device:/dev/tpmrm0" or another name that Tss2_TctiLdr_
 * Initialize knows, such as "swtpm:host=127.0.0.1,port=2321". index: ISO_TPM2_INDEX_FIRST to
 * ISO_TPM2_INDEX_LAST. The counter need not be there yet. When the TPM is lost later, each call
 * tries to open it again. -EIO the TPM cannot be reached, -ENOMEM, and the errors of
 * iso_tpm2_counter_load. */
int iso_tpm2_counter_open(const char *tcti, uint32_t index, struct iso_counter *out,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Reads an index as text, "0x01800000" or decimal. -EINVAL it is not a number, or not within
 * ISO_TPM2_INDEX_FIRST to ISO_TPM2_INDEX_LAST.
 */
int iso_tpm2_index_parse(const char *text, uint32_t *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
