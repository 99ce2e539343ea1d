/* The latest date that the log knows. */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "firmware/audit/audit_state.h"
#include "firmware/contract/json_member.h"

enum { VALUE_SIZE = 48 }; /* long enough for the dates and words that are compared */

/* The date in a member of a record's text, in seconds since 1970; 0 if there is none. */
static int64_t date_of(const char *text, const char *member)
{
    struct tm date = {0};
    char value[VALUE_SIZE];
    if (!iso_json_member(text, member, value, sizeof value) ||
        sscanf(value, "%4d-%2d-%2dT%2d:%2d:%2d", &date.tm_year, &date.tm_mon, &date.tm_mday,
               &date.tm_hour, &date.tm_min, &date.tm_sec) != 6) {
        return 0;
    }
    date.tm_year -= 1900;
    date.tm_mon -= 1;
    return (int64_t)timegm(&date);
}

static bool member_is(const char *text, const char *member, const char *word)
{
    char value[VALUE_SIZE];
    return iso_json_member(text, member, value, sizeof value) && strcmp(value, word) == 0;
}

void iso__audit_note_clock(struct iso_audit *audit, const char *text)
{
    const int64_t written_s = date_of(text, "time");
    const bool of_clock = member_is(text, "event", "clock");
    if (of_clock && member_is(text, "reason", "accepted")) {
        audit->latest_s = written_s;
        return;
    }
    /* The record repeats the latest date before it, because the records of that date may have been
     * deleted. */
    const bool has_known = of_clock || member_is(text, "event", "log-rotated");
    const int64_t known_s = has_known ? date_of(text, "before") : 0;
    const int64_t latest_s = written_s > known_s ? written_s : known_s;
    audit->latest_s = latest_s > audit->latest_s ? latest_s : audit->latest_s;
}

int64_t iso_audit_latest_s(const struct iso_audit *audit)
{
    return audit->latest_s;
}
