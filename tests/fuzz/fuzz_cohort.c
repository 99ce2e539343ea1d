/* The cohort file. The target corrects its checksum and those of its templates. */
#include <stdlib.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "core/match/cohort.h"
#include "tests/fuzz/fuzz.h"

enum { HEADER_BYTES = 16, COUNT_BYTES = 4 };

static void mend(uint8_t *bytes, size_t size)
{
    size_t at = HEADER_BYTES + COUNT_BYTES;
    while (size >= at + 4) {
        size_t length = iso_get_u32(bytes + at);
        at += 4;
        if (length < 4 || length > size - at) {
            break;
        }
        (void)iso_put_u32(bytes + at + length - 4, iso_crc32(0, bytes + at, length - 4));
        at += length;
    }
    if (size >= HEADER_BYTES) {
        (void)iso_put_u32(bytes + 8, (uint32_t)size);
        (void)iso_put_u32(bytes + 12, iso_crc32(0, bytes + HEADER_BYTES, size - HEADER_BYTES));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *bytes = fuzz_copy(data, size);
    struct iso_cohort *cohort = NULL;
    struct iso_fault fault = {.text = ""};
    mend(bytes, size);
    if (iso_cohort_parse(bytes, size, &cohort, &fault) == 0) {
        int n = iso_cohort_size(cohort);
        fuzz_check(n >= ISO_COHORT_MIN && n <= ISO_COHORT_MAX, "a cohort of sane size");
    } else {
        fuzz_check(cohort == NULL && fault.text[0] != '\0', "a fault and no cohort");
    }
    iso_cohort_free(cohort);
    free(bytes);
    return 0;
}
