/* The file of the metric. The target corrects its length and checksum. */
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "isotherm/metric.h"
#include "tests/fuzz/fuzz.h"

enum { CHECKED_FROM = 16 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *bytes = fuzz_copy(data, size);
    struct iso_metric *metric = NULL;
    struct iso_fault fault = {.text = ""};
    if (size >= CHECKED_FROM) {
        (void)iso_put_u32(bytes + 8, (uint32_t)size);
        (void)iso_put_u32(bytes + 12, iso_crc32(0, bytes + CHECKED_FROM, size - CHECKED_FROM));
    }
    if (iso_metric_parse(bytes, size, &metric, &fault) == 0) {
        void *again = NULL;
        size_t n = 0;
        fuzz_check(iso_metric_serialise(metric, &again, &n) == 0 && n == size,
                   "the metric is written again with the same length");
        free(again);
    } else {
        fuzz_check(metric == NULL && fault.text[0] != '\0', "a fault and no metric");
    }
    iso_metric_free(metric);
    free(bytes);
    return 0;
}
