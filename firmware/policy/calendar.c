#include "firmware/policy/calendar.h"

enum { EPOCH_YEAR = 1970, THURSDAY = 4 };

bool iso_calendar_is_leap(int64_t year)
{
    return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
}

/* How many leap years there are from the year 1 to this one. */
static int64_t leap_years(int64_t year)
{
    return iso_calendar_floor_div(year, 4) - iso_calendar_floor_div(year, 100) +
           iso_calendar_floor_div(year, 400);
}

int64_t iso_calendar_year_day(int64_t year)
{
    return 365 * (year - EPOCH_YEAR) + leap_years(year - 1) - leap_years(EPOCH_YEAR - 1);
}

int iso_calendar_month_days(int64_t year, int month)
{
    static const int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    return days[month - 1] + (month == 2 && iso_calendar_is_leap(year));
}

int64_t iso_calendar_day(int64_t year, int month, int day_of_month)
{
    static const int days_before[12] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};
    return iso_calendar_year_day(year) + days_before[month - 1] +
           (month > 2 && iso_calendar_is_leap(year)) + day_of_month - 1;
}

int64_t iso_calendar_year(int64_t day)
{
    /* 400 years have 146097 days, so the estimate is wrong by one year at most. */
    int64_t year = EPOCH_YEAR + iso_calendar_floor_div(day * 400, 146097);
    while (iso_calendar_year_day(year) > day) {
        year--;
    }
    while (iso_calendar_year_day(year + 1) <= day) {
        year++;
    }
    return year;
}

int iso_calendar_weekday(int64_t day)
{
    const int64_t weekday = (day + THURSDAY) % ISO_WEEKDAYS;
    return (int)(weekday < 0 ? weekday + ISO_WEEKDAYS : weekday);
}
