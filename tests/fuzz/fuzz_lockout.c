/* What the lock-out remembers, as it is read from its file. */
#include <stdlib.h>

#include "firmware/lockout_file.h"
#include "firmware/times.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct iso_lockout_options options = {
        .failures = 5, .attacks = 3, .first_ns = 1, .longest_ns = 1000, .forget_ns = 10};
    struct iso_lockout_record record = {.failures = -7};
    struct iso_lockout lockout;
    uint8_t *text = fuzz_copy(data, size);
    const int error = iso_lockout_parse((const char *)text, size, &record);
    if (error == 0) {
        iso_lockout_init(&lockout, &options);
        iso_lockout_restore(&lockout, &record, 0);
        fuzz_check(iso_lockout_remaining_ns(&lockout, 0) <= options.longest_ns,
                   "no lock is longer than the longest");
        fuzz_check((record.remaining_ns > 0 || record.lockdown) ==
                       (iso_lockout_refusal(&lockout) != ISO_REASON_NONE),
                   "what was shut is shut");
    } else {
        fuzz_check(record.failures == -7, "an output untouched");
    }
    free(text);
    return 0;
}
