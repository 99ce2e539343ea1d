#include "firmware/contract/validity.h"

#include <stdio.h>
#include <time.h>

#include "drivers/base/times.h"

const char *iso_validity_date(int64_t seconds, char text[ISO_VALIDITY_DATE_SIZE])
{
    const time_t time = (time_t)seconds;
    struct tm fields;
    if (!gmtime_r(&time, &fields) ||
        strftime(text, ISO_VALIDITY_DATE_SIZE, "%Y-%m-%dT%H:%M:%SZ", &fields) == 0) {
        (void)snprintf(text, ISO_VALIDITY_DATE_SIZE, "@%lld", (long long)seconds);
    }
    return text;
}

struct iso_validity iso_validity_after(const struct iso_validity *before,
                                       const struct iso_validity_change *change)
{
    return (struct iso_validity){
        .from_s = change->names_from ? change->limits.from_s : before->from_s,
        .until_s = change->names_until ? change->limits.until_s : before->until_s,
    };
}

bool iso_validity_is_same(const struct iso_validity *a, const struct iso_validity *b)
{
    return a->from_s == b->from_s && a->until_s == b->until_s;
}

bool iso_validity_is_fine(const struct iso_validity *before,
                          const struct iso_validity_change *change, int64_t now_s,
                          char flaw[ISO_VALIDITY_FLAW_SIZE])
{
    const struct iso_validity after = iso_validity_after(before, change);
    char date[ISO_VALIDITY_DATE_SIZE];
    if (after.from_s < 0 || after.until_s < 0) {
        (void)snprintf(flaw, ISO_VALIDITY_FLAW_SIZE, "the time of validity is before 1970");
        return false;
    }
    if (after.until_s != 0 && after.until_s <= after.from_s) {
        (void)snprintf(flaw, ISO_VALIDITY_FLAW_SIZE, "the time of validity is empty");
        return false;
    }
    if (change->names_until && after.until_s != 0 && after.until_s < now_s &&
        iso_wall_is_set(now_s) && !change->expired) {
        (void)snprintf(flaw, ISO_VALIDITY_FLAW_SIZE,
                       "the time of validity ended in the past, %s (--expired accepts it)",
                       iso_validity_date(after.until_s, date));
        return false;
    }
    return true;
}

void iso_validity_text(const struct iso_validity *validity, char text[ISO_VALIDITY_TEXT_SIZE])
{
    const bool from = validity->from_s != 0, until = validity->until_s != 0;
    char first[ISO_VALIDITY_DATE_SIZE], last[ISO_VALIDITY_DATE_SIZE];
    if (!from && !until) {
        (void)snprintf(text, ISO_VALIDITY_TEXT_SIZE, "no limits");
        return;
    }
    (void)snprintf(text, ISO_VALIDITY_TEXT_SIZE, "%s%s%s%s%s", from ? "from " : "",
                   from ? iso_validity_date(validity->from_s, first) : "", from && until ? " " : "",
                   until ? "until " : "", until ? iso_validity_date(validity->until_s, last) : "");
}
