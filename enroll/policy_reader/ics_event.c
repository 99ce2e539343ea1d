#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "enroll/policy_reader/ics.h"

bool ics_refuse(const struct ics_event *event, const char *format, ...)
{
    char flaw[READER_LINE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(flaw, sizeof flaw, format, arguments);
    va_end(arguments);
    (void)reader_refuse(event->calendar->line, "event \"%s\": %s", event->name, flaw);
    return false;
}

int ics_date_of(struct icaltimetype time)
{
    return time.year * 10000 + time.month * 100 + time.day;
}

int ics_dates_add(struct ics_dates *dates, int date, bool *added)
{
    int at = 0;
    while (at < dates->n && dates->dates[at] < date) {
        at++;
    }
    *added = at == dates->n || dates->dates[at] != date;
    if (*added && dates->n == ICS_DATES_MAX) {
        return -1;
    }
    if (*added) {
        memmove(&dates->dates[at + 1], &dates->dates[at],
                (size_t)(dates->n - at) * sizeof *dates->dates);
        dates->dates[at] = date;
        dates->n++;
    }
    return at;
}

static icalproperty *first(const struct ics_event *event, icalproperty_kind kind)
{
    return icalcomponent_get_first_property(event->component, kind);
}

/* Whether the date exists. */
static bool is_date(struct icaltimetype time)
{
    return time.year >= 1970 && time.year <= 9999 && time.month >= 1 && time.month <= 12 &&
           time.day >= 1 && time.day <= icaltime_days_in_month(time.month, time.year);
}

/* Reads DTSTART and the end, which may be a DURATION. */
static bool read_times(const struct ics_event *event, struct icaltimetype *start,
                       struct icaltimetype *end)
{
    icalproperty *start_property = first(event, ICAL_DTSTART_PROPERTY);
    icalproperty *end_property = first(event, ICAL_DTEND_PROPERTY);
    icalproperty *duration = first(event, ICAL_DURATION_PROPERTY);
    if (!start_property) {
        return ics_refuse(event, "has no DTSTART");
    }
    *start = icalproperty_get_dtstart(start_property);
    if (!is_date(*start)) {
        return ics_refuse(event, "DTSTART is not a date from 1970 on");
    }
    if (end_property) {
        *end = icalproperty_get_dtend(end_property);
    } else if (duration) {
        *end = icaltime_add(*start, icalproperty_get_duration(duration));
    } else {
        *end = *start;
        icaltime_adjust(end, start->is_date ? 1 : 0, 0, 0, 0);
    }
    if (!is_date(*end) || end->is_date != start->is_date) {
        return ics_refuse(event, "its end is not a date like its beginning");
    }
    return true;
}

/* ---- whole days ---- */

static bool add_whole_days(const struct ics_event *event, struct icaltimetype start,
                           struct icaltimetype end)
{
    if (first(event, ICAL_RRULE_PROPERTY) || first(event, ICAL_RDATE_PROPERTY)) {
        return ics_refuse(event, "a whole day that repeats cannot be kept: special days are dates, "
                                 "so make an event for each year");
    }
    if (ics_date_of(end) <= ics_date_of(start)) {
        return ics_refuse(event, "ends before it begins");
    }
    for (struct icaltimetype day = start; ics_date_of(day) < ics_date_of(end);
         icaltime_adjust(&day, 1, 0, 0, 0)) {
        bool added;
        if (ics_dates_add(&event->calendar->closed, ics_date_of(day), &added) < 0) {
            return ics_refuse(event, "the calendar has more than %d special days", ICS_DATES_MAX);
        }
    }
    return true;
}

/* ---- hours of the week ---- */

/* The zone of a time of the event, in `zone`. */
static bool read_zone(const struct ics_event *event, icalproperty *property,
                      struct icaltimetype time, char zone[ICS_NAME_SIZE])
{
    const icalparameter *parameter = icalproperty_get_first_parameter(property,
                                                                      ICAL_TZID_PARAMETER);
    const char *name = parameter               ? icalparameter_get_tzid(parameter)
                       : icaltime_is_utc(time) ? "UTC"
                                               : event->calendar->zone;
    if (!name) {
        return ics_refuse(event, "its time has no time zone: name one with --zone");
    }
    (void)snprintf(zone, ICS_NAME_SIZE, "%s", name);
    return true;
}

static bool has_other_parts(const struct icalrecurrencetype *rule)
{
    return rule->by_second[0] != ICAL_RECURRENCE_ARRAY_MAX ||
           rule->by_minute[0] != ICAL_RECURRENCE_ARRAY_MAX ||
           rule->by_hour[0] != ICAL_RECURRENCE_ARRAY_MAX ||
           rule->by_month_day[0] != ICAL_RECURRENCE_ARRAY_MAX ||
           rule->by_year_day[0] != ICAL_RECURRENCE_ARRAY_MAX ||
           rule->by_week_no[0] != ICAL_RECURRENCE_ARRAY_MAX ||
           rule->by_month[0] != ICAL_RECURRENCE_ARRAY_MAX ||
           rule->by_set_pos[0] != ICAL_RECURRENCE_ARRAY_MAX || rule->rscale;
}

/* Reads the rule as weekdays, 0 for Sunday. */
static bool read_weekdays(const struct ics_event *event, struct icaltimetype start, bool days[7])
{
    icalproperty *property = first(event, ICAL_RRULE_PROPERTY);
    if (!property) {
        return ics_refuse(event, "happens once; only what repeats every week becomes hours");
    }
    if (icalcomponent_count_properties(event->component, ICAL_RRULE_PROPERTY) > 1) {
        return ics_refuse(event, "has more than one RRULE");
    }
    const struct icalrecurrencetype rule = icalproperty_get_rrule(property);
    if ((rule.freq != ICAL_WEEKLY_RECURRENCE && rule.freq != ICAL_DAILY_RECURRENCE) ||
        has_other_parts(&rule)) {
        return ics_refuse(event, "repeats neither every week nor every day");
    }
    if (rule.interval != 1) {
        return ics_refuse(event, "INTERVAL=%d: a schedule is the same every week", rule.interval);
    }
    if (rule.count != 0 || !icaltime_is_null_time(rule.until)) {
        return ics_refuse(event, "%s: the hours of a schedule have no end",
                          rule.count != 0 ? "COUNT" : "UNTIL");
    }
    const int weekday = icaltime_day_of_week(start) - 1;
    if (rule.by_day[0] == ICAL_RECURRENCE_ARRAY_MAX) {
        for (int day = 0; day < 7; day++) {
            days[day] = rule.freq == ICAL_DAILY_RECURRENCE || day == weekday;
        }
        return true;
    }
    for (int i = 0; i < ICAL_BY_DAY_SIZE && rule.by_day[i] != ICAL_RECURRENCE_ARRAY_MAX; i++) {
        if (icalrecurrencetype_day_position(rule.by_day[i]) != 0) {
            return ics_refuse(event, "BYDAY has a number, which every week does not need");
        }
        days[icalrecurrencetype_day_day_of_week(rule.by_day[i]) - 1] = true;
    }
    return days[weekday] || ics_refuse(event, "DTSTART is on no day of BYDAY");
}

/* Finds the schedule of the event, or makes it. */
static struct ics_schedule *find_schedule(const struct ics_event *event, const char *zone)
{
    struct ics_calendar *calendar = event->calendar;
    const char *token = calendar->name[0] ? calendar->name : event->name;
    for (int i = 0; i < calendar->n_schedules; i++) {
        struct ics_schedule *schedule = &calendar->schedules[i];
        if (strcmp(schedule->token, token) == 0) {
            return strcmp(schedule->zone, zone) == 0 ||
                           ics_refuse(event,
                                      "has the time zone %s, and other events of \"%s\" have %s",
                                      zone, token, schedule->zone)
                       ? schedule
                       : NULL;
        }
    }
    if (calendar->n_schedules == ICS_SCHEDULES_MAX) {
        (void)ics_refuse(event, "the calendar has more than %d schedules", ICS_SCHEDULES_MAX);
        return NULL;
    }
    struct ics_schedule *schedule = &calendar->schedules[calendar->n_schedules++];
    (void)snprintf(schedule->token, sizeof schedule->token, "%s", token);
    (void)snprintf(schedule->zone, sizeof schedule->zone, "%s", zone);
    return schedule;
}

/* Adds the days that the event leaves out. */
static bool add_exceptions(const struct ics_event *event, struct ics_schedule *schedule,
                           const bool days[7], bool passes_midnight)
{
    for (icalproperty *property = first(event, ICAL_EXDATE_PROPERTY); property;
         property = icalcomponent_get_next_property(event->component, ICAL_EXDATE_PROPERTY)) {
        const struct icaltimetype time = icalproperty_get_exdate(property);
        bool added;
        if (!is_date(time)) {
            return ics_refuse(event, "EXDATE is not a date from 1970 on");
        }
        if (!days[icaltime_day_of_week(time) - 1]) {
            continue; /* it does not take place on that day anyway */
        }
        if (passes_midnight) {
            return ics_refuse(event, "EXDATE of an event that passes midnight cannot be kept");
        }
        const int at = ics_dates_add(&schedule->exceptions, ics_date_of(time), &added);
        if (at < 0) {
            return ics_refuse(event, "\"%s\" has more than %d exceptions", schedule->token,
                              ICS_DATES_MAX);
        }
        if (added) {
            memmove(&schedule->seen[at + 1], &schedule->seen[at],
                    (size_t)(schedule->exceptions.n - 1 - at) * sizeof *schedule->seen);
            schedule->seen[at] = 0;
        }
        schedule->seen[at]++;
    }
    return true;
}

static void open_minutes(struct ics_schedule *schedule, int day, int from, int to)
{
    for (int minute = from; minute < to; minute++) {
        schedule->open[(day + minute / ICS_DAY_MINUTES) % 7][minute % ICS_DAY_MINUTES] = true;
    }
}

static bool add_weekly(const struct ics_event *event, struct icaltimetype start,
                       struct icaltimetype end)
{
    char zone[ICS_NAME_SIZE], end_zone[ICS_NAME_SIZE];
    bool days[7] = {false};
    icalproperty *end_property = first(event, ICAL_DTEND_PROPERTY);
    if (!read_weekdays(event, start, days) ||
        !read_zone(event, first(event, ICAL_DTSTART_PROPERTY), start, zone) ||
        (end_property && !read_zone(event, end_property, end, end_zone))) {
        return false;
    }
    if (end_property && strcmp(zone, end_zone) != 0) {
        return ics_refuse(event, "begins in the time zone %s and ends in %s", zone, end_zone);
    }
    if (first(event, ICAL_RDATE_PROPERTY)) {
        return ics_refuse(event, "RDATE: a schedule has no further days");
    }
    if (ics_date_of(start) > event->calendar->today) {
        return ics_refuse(event, "begins in the future, and the hours of a schedule do not");
    }
    if (start.second != 0 || end.second != 0) {
        return ics_refuse(event, "begins or ends within a minute");
    }
    start.zone = end.zone = NULL; /* what the clock on the wall shows */
    struct icaltimetype next = start;
    icaltime_adjust(&next, 1, 0, 0, 0);
    const bool is_next_day = ics_date_of(end) == ics_date_of(next);
    const int from = start.hour * 60 + start.minute;
    const int to = end.hour * 60 + end.minute + (is_next_day ? ICS_DAY_MINUTES : 0);
    if ((!is_next_day && ics_date_of(end) != ics_date_of(start)) || to <= from ||
        to - from > ICS_DAY_MINUTES) {
        return ics_refuse(event, "lasts no time, or more than a day");
    }
    struct ics_schedule *schedule = find_schedule(event, zone);
    if (!schedule || !add_exceptions(event, schedule, days, to > ICS_DAY_MINUTES)) {
        return false;
    }
    for (int day = 0; day < 7; day++) {
        if (days[day]) {
            schedule->per_day[day]++;
            schedule->per_day[(day + 1) % 7] += to > ICS_DAY_MINUTES;
            open_minutes(schedule, day, from, to);
        }
    }
    return true;
}

bool ics_add_event(struct ics_event *event)
{
    struct icaltimetype start, end;
    if (icalcomponent_get_status(event->component) == ICAL_STATUS_CANCELLED) {
        return true;
    }
    icalproperty *wrong = first(event, ICAL_XLICERROR_PROPERTY);
    if (wrong) {
        return ics_refuse(event, "is not iCalendar: %s", icalproperty_get_xlicerror(wrong));
    }
    if (first(event, ICAL_RECURRENCEID_PROPERTY)) {
        return ics_refuse(event, "RECURRENCE-ID: one day of another event cannot be changed");
    }
    if (first(event, ICAL_EXRULE_PROPERTY)) {
        return ics_refuse(event, "EXRULE: a schedule has no rule for exceptions");
    }
    if (!read_times(event, &start, &end)) {
        return false;
    }
    return start.is_date ? add_whole_days(event, start, end) : add_weekly(event, start, end);
}
