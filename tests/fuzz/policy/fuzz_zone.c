/* The reader of time zones, and the reader of their rules. */
#include "firmware/policy/schedule.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>

static void check_times(const struct iso_zone *zone)
{
    static const int64_t times_s[] = {-(INT64_C(1) << 60), -1, 0, 1795608000, INT64_C(1) << 40};
    for (size_t i = 0; i < sizeof times_s / sizeof *times_s; i++) {
        const struct iso_wall_clock now = iso_wall_clock_at(zone, times_s[i]);
        fuzz_check(now.minute >= 0 && now.minute < 1440, "a minute of a day");
        fuzz_check(llabs(now.day - times_s[i] / 86400) <= 3, "a day near that of UTC");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *bytes = fuzz_copy(data, size);
    static struct iso_zone zone;
    struct iso_fault fault = {0};
    if (iso_zone_read("Fuzz/Zone", bytes, size, &zone, &fault) == 0) {
        check_times(&zone);
    } else {
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    static struct iso_zone rule_only = {.name = "rule"};
    if (iso_zone_rule_read((const char *)bytes, size, &rule_only.rule) == 0) {
        check_times(&rule_only);
    }
    free(bytes);
    return 0;
}
