#include "firmware/policy/document/day_text.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "firmware/policy/calendar.h"

static const char *const weekdays[ISO_WEEKDAYS] = {"sunday",   "monday", "tuesday", "wednesday",
                                                   "thursday", "friday", "saturday"};

/* Whether the text has the form, in which '0' stands for any digit. */
static bool has_form(const char *text, const char *form)
{
    for (; *form; form++, text++) {
        const bool fits = *form == '0' ? *text >= '0' && *text <= '9' : *text == *form;
        if (!fits) {
            return false;
        }
    }
    return *text == '\0';
}

static int number(const char *digits, int n)
{
    int value = 0;
    for (int i = 0; i < n; i++) {
        value = 10 * value + (digits[i] - '0');
    }
    return value;
}

int iso_date_read(const char *text, int32_t *day)
{
    if (!has_form(text, "0000-00-00")) {
        return -EINVAL;
    }
    const int year = number(text, 4), month = number(text + 5, 2), date = number(text + 8, 2);
    if (year < 1970 || month < 1 || month > 12 || date < 1 ||
        date > iso_calendar_month_days(year, month)) {
        return -EINVAL;
    }
    *day = (int32_t)iso_calendar_day(year, month, date);
    return 0;
}

void iso_date_write(int32_t day, char text[ISO_DATE_TEXT_SIZE])
{
    const int64_t year = iso_calendar_year(day);
    int month = 12;
    while (iso_calendar_day(year, month, 1) > day) {
        month--;
    }
    (void)snprintf(text, ISO_DATE_TEXT_SIZE, "%04d-%02d-%02d", (int)year % 10000, month % 100,
                   (int)(day - iso_calendar_day(year, month, 1) + 1) % 100);
}

/* Reads "09:00". Returns the minute of the day, or -1. */
static int minute_of(const char *text, int latest)
{
    const int hour = number(text, 2), minute = number(text + 3, 2);
    return minute < 60 && hour * 60 + minute <= latest ? hour * 60 + minute : -1;
}

int iso_period_read(const char *text, struct iso_period *period)
{
    if (!has_form(text, "00:00-00:00")) {
        return -EINVAL;
    }
    const int from = minute_of(text, ISO_DAY_MINUTES - 1),
              to = minute_of(text + 6, ISO_DAY_MINUTES);
    if (from < 0 || to < 0) {
        return -EINVAL;
    }
    *period = (struct iso_period){(uint16_t)from, (uint16_t)to};
    return 0;
}

void iso_period_write(const struct iso_period *period, char text[ISO_PERIOD_TEXT_SIZE])
{
    (void)snprintf(text, ISO_PERIOD_TEXT_SIZE, "%02u:%02u-%02u:%02u", period->from_min / 60U % 100,
                   period->from_min % 60U, period->to_min / 60U % 100, period->to_min % 60U);
}

static int weekday_of(const char *text, size_t size)
{
    for (int day = 0; day < ISO_WEEKDAYS; day++) {
        if (strlen(weekdays[day]) == size && memcmp(weekdays[day], text, size) == 0) {
            return day;
        }
    }
    return -1;
}

unsigned iso_days_read(const char *text)
{
    const char *dash = strchr(text, '-');
    const int first = weekday_of(text, dash ? (size_t)(dash - text) : strlen(text));
    const int last = dash ? weekday_of(dash + 1, strlen(dash + 1)) : first;
    if (first < 0 || last < 0) {
        return 0;
    }
    unsigned days = 1U << last;
    for (int day = first; day != last; day = (day + 1) % ISO_WEEKDAYS) {
        days |= 1U << day;
    }
    return days;
}

void iso_days_write(int first, int last, char text[ISO_DAYS_TEXT_SIZE])
{
    (void)snprintf(text, ISO_DAYS_TEXT_SIZE, first == last ? "%s" : "%s-%s", weekdays[first],
                   weekdays[last]);
}
