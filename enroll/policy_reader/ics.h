/* What becomes of the events of a calendar (RFC 5545):
 *
 *   an event at times that repeats every week or every day   a period of a schedule
 *       FREQ=WEEKLY with BYDAY, or FREQ=DAILY, without an end
 *       past midnight: two periods                           events of one schedule: all of them
 *       EXDATE: a special day without hours
 *   an event of whole days that does not repeat              special days without hours
 *
 *   token of a schedule                    the calendar's name (NAME or X-WR-CALNAME); without one
 *                                          the SUMMARY of the event
 *   token of the group of special days     the calendar's name, or "holidays"
 *   token of the group of a schedule's EXDATEs     the schedule's token with " exceptions"
 *
 * All schedules of the calendar are closed on the days of its group. Cancelled events do not
 * count. Everything else is refused with a line that names the event: a schedule has weekly hours
 * and dates, and what is neither cannot be kept. */
#ifndef ISO_ENROLL_POLICY_READER_ICS_H
#define ISO_ENROLL_POLICY_READER_ICS_H

#include <libical/ical.h>
#include <stdbool.h>

#include "enroll/policy_reader/reader_input.h"

enum { ICS_DAY_MINUTES = 1440, ICS_NAME_SIZE = 80, ICS_SCHEDULES_MAX = 64, ICS_DATES_MAX = 64 };

/* Dates as YYYYMMDD, ascending, each once. */
struct ics_dates {
    int n;
    int dates[ICS_DATES_MAX];
};

/* The hours of a week, minute by minute; 0 is Sunday. `exceptions` are days on which none of its
 * events of that weekday takes place: seen[i] counts the events that leave out exceptions.dates[i],
 * per_day the events of each weekday. */
struct ics_schedule {
    char token[ICS_NAME_SIZE], zone[ICS_NAME_SIZE];
    bool open[7][ICS_DAY_MINUTES];
    int per_day[7];
    struct ics_dates exceptions;
    int seen[ICS_DATES_MAX];
};

/* A calendar while it is read. */
struct ics_calendar {
    char name[ICS_NAME_SIZE]; /* "": it has none */
    const char *zone;         /* of times without one; NULL: none */
    int today;
    struct ics_schedule *schedules;
    int n_schedules;
    struct ics_dates closed; /* whole days */
    struct reader_line *line;
};

/* An event: its name for lines, and where it is. */
struct ics_event {
    struct ics_calendar *calendar;
    icalcomponent *component;
    char name[ICS_NAME_SIZE];
};

/* Writes the line "event "NAME": ..." and returns false. */
bool ics_refuse(const struct ics_event *event, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Adds an event to the calendar. Returns false with a line if it cannot be kept. */
bool ics_add_event(struct ics_event *event);

/* Adds a date. Returns its position, or -1 if there is no room. *added says whether it is new. */
int ics_dates_add(struct ics_dates *dates, int date, bool *added);

/* A date as YYYYMMDD. */
int ics_date_of(struct icaltimetype time);

#endif
