#include "enroll/cli/arguments/when_next.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "enroll/cli/arguments/when.h"

static const char *const weekdays[7] = {"Sunday",   "Monday", "Tuesday", "Wednesday",
                                        "Thursday", "Friday", "Saturday"};

/* Reads "9:00" or "09:00". Returns the minute of the day, or -1. */
static int minute_of(const char *text)
{
    int hour = 0, minute = 0;
    const char *c = text;

    for (; *c >= '0' && *c <= '9' && c - text < 2; c++) {
        hour = 10 * hour + (*c - '0');
    }
    if (c == text || *c != ':') {
        return -1;
    }
    const char *minutes = ++c;
    for (; *c >= '0' && *c <= '9' && c - minutes < 2; c++) {
        minute = 10 * minute + (*c - '0');
    }
    return c - minutes == 2 && *c == '\0' && hour < 24 && minute < 60 ? hour * 60 + minute : -1;
}

/* A time of a day that is `days` after that of `now`. Returns false where the clock leaves the time
 * out. */
static bool at_minute(const struct tm *now, int days, int minute, int64_t *unix_s)
{
    struct tm fields = {.tm_year = now->tm_year,
                        .tm_mon = now->tm_mon,
                        .tm_mday = now->tm_mday + days,
                        .tm_hour = minute / 60,
                        .tm_min = minute % 60,
                        .tm_isdst = -1};
    const time_t value = mktime(&fields);

    if (value <= 0 || fields.tm_hour * 60 + fields.tm_min != minute) {
        return false;
    }
    *unix_s = value;
    return true;
}

/* How many days after today the day is, or -1. */
static int days_until(const char *word, size_t size, const struct tm *now)
{
    static const char *const relative[] = {"today", "tomorrow"};

    for (int i = 0; i < 2; i++) {
        if (strlen(relative[i]) == size && strncasecmp(relative[i], word, size) == 0) {
            return i;
        }
    }
    for (int day = 0; day < 7; day++) {
        if (strlen(weekdays[day]) == size && strncasecmp(weekdays[day], word, size) == 0) {
            return (day - now->tm_wday + 7) % 7;
        }
    }
    return -1;
}

bool cli_when_parse_next(const char *text, int64_t now_s, int64_t *unix_s)
{
    const time_t seconds = (time_t)now_s;
    struct tm now;
    int64_t found;

    if (strcmp(text, "now") == 0) {
        *unix_s = now_s;
        return true;
    }
    if (!localtime_r(&seconds, &now)) {
        return false;
    }
    const int today = minute_of(text);
    if (today >= 0) {
        return at_minute(&now, 0, today, unix_s);
    }
    const char *gap = strpbrk(text, " 0123456789");
    const bool has_t = gap && gap > text && *gap != ' ' && gap[-1] == 'T';
    const int days = gap ? days_until(text, (size_t)(gap - text) - has_t, &now) : -1;
    const int minute = gap && (has_t || *gap == ' ') ? minute_of(gap + (*gap == ' ')) : -1;
    if (days < 0 || minute < 0) {
        return cli_when_parse(text, false, unix_s);
    }
    if (!at_minute(&now, days, minute, &found)) {
        return false;
    }
    const bool is_weekday = strncasecmp(text, "to", 2) != 0; /* neither today nor tomorrow */
    if (is_weekday && days == 0 && found < now_s) {
        return at_minute(&now, 7, minute, unix_s);
    }
    *unix_s = found;
    return true;
}

void cli_when_format_day(int64_t unix_s, char text[CLI_WHEN_DAY_SIZE])
{
    const time_t seconds = (time_t)unix_s;
    struct tm fields;
    char date[CLI_WHEN_DAY_SIZE];

    if (!localtime_r(&seconds, &fields) ||
        strftime(date, sizeof date, "%Y-%m-%d at %H:%M", &fields) == 0) {
        (void)snprintf(text, CLI_WHEN_DAY_SIZE, "-");
        return;
    }
    (void)snprintf(text, CLI_WHEN_DAY_SIZE, "%.10s %.36s", weekdays[fields.tm_wday % 7], date);
}
