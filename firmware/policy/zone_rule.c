#include "firmware/policy/zone_rule.h"

#include <errno.h>

#include "firmware/policy/calendar.h"

enum { HOUR_S = 3600, MINUTE_S = 60, RULE_HOURS_MAX = 167, OFFSET_HOURS_MAX = 24 };

/* What is left of the text. */
struct reader {
    const char *at, *end;
    bool failed;
};

static char next_byte(const struct reader *in)
{
    return in->at < in->end ? *in->at : '\0';
}

static bool skip(struct reader *in, char c)
{
    const bool found = next_byte(in) == c && c != '\0';
    in->at += found;
    return found;
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_letter(char c)
{
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

/* A number of at least one digit between min and max. */
static int read_number(struct reader *in, int min, int max)
{
    int number = 0;
    const char *start = in->at;
    while (is_digit(next_byte(in)) && number <= max) {
        number = 10 * number + (*in->at++ - '0');
    }
    if (in->at == start || number < min || number > max) {
        in->failed = true;
        return 0;
    }
    return number;
}

/* The abbreviation of a clock: three letters or more, or letters, digits and signs in brackets. It
 * is not kept. */
static void read_name(struct reader *in)
{
    const bool quoted = skip(in, '<');
    const char *start = in->at;
    while (is_letter(next_byte(in)) ||
           (quoted && (is_digit(next_byte(in)) || next_byte(in) == '+' || next_byte(in) == '-'))) {
        in->at++;
    }
    if (in->at - start < 3 || (quoted && !skip(in, '>'))) {
        in->failed = true;
    }
}

/* [+-]hh[:mm[:ss]] as seconds. */
static int32_t read_time_s(struct reader *in, int hours_max)
{
    const bool negative = skip(in, '-');
    if (!negative) {
        (void)skip(in, '+');
    }
    int32_t time_s = read_number(in, 0, hours_max) * HOUR_S;
    if (skip(in, ':')) {
        time_s += read_number(in, 0, 59) * MINUTE_S;
        if (skip(in, ':')) {
            time_s += read_number(in, 0, 59);
        }
    }
    return negative ? -time_s : time_s;
}

static struct iso_zone_change read_change(struct reader *in)
{
    struct iso_zone_change change = {.time_s = 2 * HOUR_S};
    if (!skip(in, ',')) {
        in->failed = true;
    } else if (skip(in, 'M')) {
        change.kind = ISO_ZONE_DAY_OF_WEEK;
        change.month = (uint8_t)read_number(in, 1, 12);
        in->failed |= !skip(in, '.');
        change.week = (uint8_t)read_number(in, 1, 5);
        in->failed |= !skip(in, '.');
        change.wday = (uint8_t)read_number(in, 0, 6);
    } else if (skip(in, 'J')) {
        change.kind = ISO_ZONE_DAY_JULIAN;
        change.day = (int16_t)read_number(in, 1, 365);
    } else {
        change.kind = ISO_ZONE_DAY_OF_YEAR;
        change.day = (int16_t)read_number(in, 0, 365);
    }
    if (skip(in, '/')) {
        change.time_s = read_time_s(in, RULE_HOURS_MAX);
    }
    return change;
}

int iso_zone_rule_read(const char *text, size_t size, struct iso_zone_rule *rule)
{
    struct reader in = {.at = text, .end = text + size};
    struct iso_zone_rule read = {0};
    read_name(&in);
    /* POSIX counts the offsets to the west. */
    read.standard_s = -read_time_s(&in, OFFSET_HOURS_MAX);
    if (!in.failed && in.at < in.end) {
        read.has_summer = true;
        read_name(&in);
        const char c = next_byte(&in);
        read.summer_s = c == '+' || c == '-' || is_digit(c) ? -read_time_s(&in, OFFSET_HOURS_MAX)
                                                            : read.standard_s + HOUR_S;
        read.to_summer = read_change(&in);
        read.to_standard = read_change(&in);
    }
    if (in.failed || in.at != in.end) {
        return -EINVAL;
    }
    *rule = read;
    return 0;
}

static bool is_between(int64_t number, int64_t min, int64_t max)
{
    return number >= min && number <= max;
}

static bool change_is_sound(const struct iso_zone_change *change)
{
    const int64_t time_max_s = (RULE_HOURS_MAX + 1) * HOUR_S - 1;
    if (!is_between(change->time_s, -time_max_s, time_max_s)) {
        return false;
    }
    switch (change->kind) {
    case ISO_ZONE_DAY_JULIAN:
        return is_between(change->day, 1, 365);
    case ISO_ZONE_DAY_OF_YEAR:
        return is_between(change->day, 0, 365);
    case ISO_ZONE_DAY_OF_WEEK:
        return is_between(change->month, 1, 12) && is_between(change->week, 1, 5) &&
               change->wday <= 6;
    default:
        return false;
    }
}

bool iso_zone_rule_is_sound(const struct iso_zone_rule *rule)
{
    const int32_t max_s = (OFFSET_HOURS_MAX + 1) * HOUR_S - 1;
    if (!is_between(rule->standard_s, -max_s, max_s)) {
        return false;
    }
    return !rule->has_summer ||
           (is_between(rule->summer_s, -max_s, max_s + HOUR_S) &&
            change_is_sound(&rule->to_summer) && change_is_sound(&rule->to_standard));
}

static int64_t change_day(const struct iso_zone_change *change, int64_t year)
{
    if (change->kind == ISO_ZONE_DAY_OF_YEAR) {
        return iso_calendar_year_day(year) + change->day;
    }
    if (change->kind == ISO_ZONE_DAY_JULIAN) {
        return iso_calendar_year_day(year) + change->day - 1 +
               (iso_calendar_is_leap(year) && change->day >= 60);
    }
    const int64_t first = iso_calendar_day(year, change->month, 1);
    const int to_wday = (change->wday - iso_calendar_weekday(first) + ISO_WEEKDAYS) % ISO_WEEKDAYS;
    int day = to_wday + ISO_WEEKDAYS * (change->week - 1);
    if (day >= iso_calendar_month_days(year, change->month)) {
        day -= ISO_WEEKDAYS;
    }
    return first + day;
}

/* The changes of one year, each by the clock that is in force before it. */
static int64_t change_s(const struct iso_zone_change *change, int64_t year, int32_t offset_before_s)
{
    return change_day(change, year) * ISO_DAY_S + change->time_s - offset_before_s;
}

int32_t iso_zone_rule_offset_s(const struct iso_zone_rule *rule, int64_t time_s)
{
    if (!rule->has_summer) {
        return rule->standard_s;
    }
    const int64_t year = iso_calendar_year(
        iso_calendar_floor_div(time_s + rule->standard_s, ISO_DAY_S));
    const int64_t summer = change_s(&rule->to_summer, year, rule->standard_s);
    const int64_t standard = change_s(&rule->to_standard, year, rule->summer_s);
    /* In the south the summer begins in one year and ends in the next. */
    const bool is_summer = summer < standard ? time_s >= summer && time_s < standard
                                             : time_s < standard || time_s >= summer;
    return is_summer ? rule->summer_s : rule->standard_s;
}
