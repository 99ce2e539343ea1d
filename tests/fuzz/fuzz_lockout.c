/* The lock-out file: the text of format 1, and the sealed bytes of format 2. */
#include <stdlib.h>
#include <string.h>

#include "drivers/base/times.h"
#include "firmware/visit/lockout_file.h"
#include "tests/fuzz/fuzz.h"

static void restore(const struct iso_lockout_record *record)
{
    static const struct iso_lockout_options options = {
        .failures = 5, .attacks = 3, .first_ns = 1, .longest_ns = 1000, .forget_ns = 10};
    struct iso_lockout lockout;
    iso_lockout_init(&lockout, &options);
    iso_lockout_restore(&lockout, record, 0);
    fuzz_check(iso_lockout_remaining_ns(&lockout, 0) <= options.longest_ns,
               "no lock is longer than the longest");
    fuzz_check((record->remaining_ns > 0 || record->lockdown) ==
                   (iso_lockout_refusal(&lockout) != ISO_REASON_NONE),
               "a lock-out and a lockdown are kept");
}

static void try_text(const char *text, size_t size)
{
    struct iso_lockout_record record = {.failures = -7};
    if (iso_lockout_parse(text, size, &record) == 0) {
        restore(&record);
    } else {
        fuzz_check(record.failures == -7, "the output is unchanged after an error");
    }
}

/* Reads the bytes as if they had been unsealed. */
static void try_plain(const uint8_t *data, size_t size)
{
    struct iso_lockout_file file = {.number = 77};
    uint8_t again[ISO_LOCKOUT_PLAIN_BYTES];
    if (iso_lockout_get(data, size, &file) == 0) {
        iso_lockout_put(&file, again);
        fuzz_check(size == sizeof again && memcmp(again, data, size) == 0,
                   "a file that was read is written again with the same bytes");
        restore(&file.record);
    } else {
        fuzz_check(file.number == 77, "the output is unchanged after an error");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *text = fuzz_copy(data, size);
    try_text((const char *)text, size);
    try_plain(text, size);
    free(text);
    return 0;
}
