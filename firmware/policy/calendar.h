/* Dates of the Gregorian calendar as numbers of days. Day 0 is 1970-01-01, a Thursday. Pure. */
#ifndef ISO_FIRMWARE_POLICY_CALENDAR_H
#define ISO_FIRMWARE_POLICY_CALENDAR_H

#include <stdbool.h>
#include <stdint.h>

enum { ISO_DAY_S = 86400, ISO_DAY_MINUTES = 1440, ISO_WEEKDAYS = 7 };

/* Whether February of the year has 29 days. */
bool iso_calendar_is_leap(int64_t year);

/* The day of the 1st of January. `year` is between -290,000,000 and 290,000,000. */
int64_t iso_calendar_year_day(int64_t year);

/* The day of a date; `month` is 1 to 12. A day of the month beyond its end counts on into the next
 * month. */
int64_t iso_calendar_day(int64_t year, int month, int day_of_month);

/* The year of a day. */
int64_t iso_calendar_year(int64_t day);

/* 0 for Sunday to 6 for Saturday, as POSIX counts. */
int iso_calendar_weekday(int64_t day);

/* How many days a month has. */
int iso_calendar_month_days(int64_t year, int month);

/* Divides by a positive number and rounds down also for negative numbers, as days and hours before
 * 1970 need it. It is here so that the compiler knows the divisor: a decision does many of these.
 */
static inline int64_t iso_calendar_floor_div(int64_t a, int64_t b)
{
    return a / b - (a % b < 0);
}

#endif
