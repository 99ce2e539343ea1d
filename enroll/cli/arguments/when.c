#include "enroll/cli/arguments/when.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static bool parse_seconds(const char *text, int64_t *unix_s)
{
    char *end;

    if (*text < '0' || *text > '9') {
        return false;
    }
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    if (errno || *end || value <= 0) {
        return false;
    }
    *unix_s = value;
    return true;
}

/* mktime() and timegm() change 30 February to 2 March. If they return a different date, the given
 * date does not exist. */
static bool to_unix(const struct tm *fields, bool utc, int64_t *unix_s)
{
    struct tm made = *fields;
    const time_t value = utc ? timegm(&made) : mktime(&made);

    if (value <= 0 || made.tm_mday != fields->tm_mday || made.tm_mon != fields->tm_mon) {
        return false;
    }
    *unix_s = value;
    return true;
}

bool cli_when_parse(const char *text, bool end_of_day, int64_t *unix_s)
{
    static const char *const clocks[] = {"T%H:%M:%S", "T%H:%M", " %H:%M:%S", " %H:%M", ""};

    if (text[0] == '@') {
        return parse_seconds(text + 1, unix_s);
    }
    for (size_t i = 0; i < sizeof clocks / sizeof *clocks; i++) {
        struct tm fields = {.tm_isdst = -1};
        const char *rest = strptime(text, "%Y-%m-%d", &fields);
        if (!rest) {
            return false;
        }
        const bool date_only = clocks[i][0] == '\0';
        rest = date_only ? rest : strptime(rest, clocks[i], &fields);
        if (!rest || (*rest && strcmp(rest, "Z") != 0)) {
            continue;
        }
        if (date_only && end_of_day) {
            fields.tm_hour = 23;
            fields.tm_min = fields.tm_sec = 59;
        }
        return to_unix(&fields, *rest == 'Z', unix_s);
    }
    return false;
}

/* The first second of a day. A day after the end of a month is a day of the next month. */
static bool first_second(int year, int month, int day, int64_t *unix_s)
{
    struct tm fields = {.tm_year = year, .tm_mon = month, .tm_mday = day, .tm_isdst = -1};
    const time_t value = mktime(&fields);

    *unix_s = value;
    return value > 0;
}

bool cli_when_parse_day(const char *text, int64_t now_s, int64_t *begins_s, int64_t *ends_s)
{
    const bool today = strcmp(text, "today") == 0;
    const time_t now = (time_t)now_s;
    struct tm day = {0};
    int64_t begins, ends;

    if (today || strcmp(text, "yesterday") == 0) {
        if (!localtime_r(&now, &day)) {
            return false;
        }
        day.tm_mday -= today ? 0 : 1;
    } else {
        const char *rest = strptime(text, "%Y-%m-%d", &day);
        int64_t sound; /* 30 February does not exist */
        if (!rest || *rest || !cli_when_parse(text, false, &sound)) {
            return false;
        }
    }
    if (!first_second(day.tm_year, day.tm_mon, day.tm_mday, &begins) ||
        !first_second(day.tm_year, day.tm_mon, day.tm_mday + 1, &ends)) {
        return false;
    }
    *begins_s = begins;
    *ends_s = ends;
    return true;
}

void cli_when_format_second(int64_t unix_s, char text[CLI_WHEN_SIZE])
{
    const time_t seconds = (time_t)unix_s;
    struct tm fields;

    if (!localtime_r(&seconds, &fields) ||
        strftime(text, CLI_WHEN_SIZE, "%Y-%m-%d %H:%M:%S", &fields) == 0) {
        (void)snprintf(text, CLI_WHEN_SIZE, "-");
    }
}

void cli_when_format(int64_t unix_s, char text[CLI_WHEN_SIZE])
{
    const time_t seconds = (time_t)unix_s;
    struct tm fields;

    if (unix_s == 0 || !localtime_r(&seconds, &fields) ||
        strftime(text, CLI_WHEN_SIZE, "%Y-%m-%d %H:%M", &fields) == 0) {
        (void)snprintf(text, CLI_WHEN_SIZE, "-");
    }
}
