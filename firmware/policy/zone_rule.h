/* The rule of a time zone for every year, as POSIX writes it in the variable TZ and RFC 8536 at the
 * end of a zone's file: "CET-1CEST,M3.5.0,M10.5.0/3". Pure. */
#ifndef ISO_FIRMWARE_POLICY_ZONE_RULE_H
#define ISO_FIRMWARE_POLICY_ZONE_RULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* How the day of a change is named. */
enum iso_zone_day {
    ISO_ZONE_DAY_JULIAN = 0, /* Jn: day 1 to 365 of the year; the 29th of February is not counted */
    ISO_ZONE_DAY_OF_YEAR = 1, /* n: day 0 to 365 of the year */
    ISO_ZONE_DAY_OF_WEEK = 2, /* Mm.w.d: a weekday of week 1 to 5 of a month; 5 is the last one */
};

/* When the clocks change in each year. */
struct iso_zone_change {
    uint8_t kind;              /* enum iso_zone_day */
    uint8_t month, week, wday; /* of ISO_ZONE_DAY_OF_WEEK; wday 0 is Sunday */
    int16_t day;               /* of the other two kinds */
    int32_t time_s;            /* after midnight of that day by the clock that is changed; it may be
                                * before that midnight or after the next one */
};

/* Offsets are seconds to add to UTC. */
struct iso_zone_rule {
    int32_t standard_s;
    bool has_summer; /* the fields below count */
    int32_t summer_s;
    struct iso_zone_change to_summer, to_standard;
};

/* Reads a rule of `size` bytes. Returns 0, or -EINVAL if it is not one; *rule is then as before. A
 * rule of summer time without the days of its changes is refused, because POSIX leaves these to
 * each system. */
int iso_zone_rule_read(const char *text, size_t size, struct iso_zone_rule *rule);

/* Whether a rule that was stored is still one that iso_zone_rule_read() can have read. */
bool iso_zone_rule_is_sound(const struct iso_zone_rule *rule);

/* The offset at a time, in seconds since 1970 UTC. */
int32_t iso_zone_rule_offset_s(const struct iso_zone_rule *rule, int64_t time_s);

#endif
