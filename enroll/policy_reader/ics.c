#include "enroll/policy_reader/ics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const weekdays[7] = {"sunday",   "monday", "tuesday", "wednesday",
                                        "thursday", "friday", "saturday"};

/* ---- what was found, as JSON ---- */

static json_t *hours_json(const bool open[ICS_DAY_MINUTES])
{
    json_t *list = json_array();
    for (int from = 0; from < ICS_DAY_MINUTES; from++) {
        if (!open[from]) {
            continue;
        }
        int to = from;
        while (to < ICS_DAY_MINUTES && open[to]) {
            to++;
        }
        char text[16];
        (void)snprintf(text, sizeof text, "%02d:%02d-%02d:%02d", from / 60, from % 60, to / 60,
                       to % 60);
        (void)json_array_append_new(list, json_string(text));
        from = to;
    }
    return list;
}

static json_t *group_json(const char *token, const struct ics_dates *dates)
{
    json_t *days = json_array();
    for (int i = 0; i < dates->n; i++) {
        char text[40];
        (void)snprintf(text, sizeof text, "%04d-%02d-%02d", dates->dates[i] / 10000,
                       dates->dates[i] / 100 % 100, dates->dates[i] % 100);
        (void)json_array_append_new(days, json_string(text));
    }
    return json_pack("{s:s, s:o}", "token", token, "days", days);
}

/* On which days no event of the schedule takes place: these alone are special days without hours.
 */
static bool check_exceptions(const struct ics_calendar *calendar,
                             const struct ics_schedule *schedule)
{
    for (int i = 0; i < schedule->exceptions.n; i++) {
        const int date = schedule->exceptions.dates[i];
        const struct icaltimetype time = {
            .year = date / 10000, .month = date / 100 % 100, .day = date % 100, .is_date = 1};
        if (schedule->seen[i] != schedule->per_day[icaltime_day_of_week(time) - 1]) {
            (void)reader_refuse(calendar->line,
                                "schedule \"%s\": not all of its events leave out %04d-%02d-%02d, "
                                "which cannot be kept",
                                schedule->token, time.year, time.month, time.day);
            return false;
        }
    }
    return true;
}

static json_t *schedule_json(const struct ics_schedule *schedule, const char *closed,
                             const char *exceptions)
{
    json_t *weekly = json_object(), *special = json_array();
    for (int day = 0; day < 7; day++) {
        json_t *hours = hours_json(schedule->open[day]);
        if (json_array_size(hours) > 0) {
            (void)json_object_set(weekly, weekdays[day], hours);
        }
        json_decref(hours);
    }
    if (closed) {
        (void)json_array_append_new(special, json_pack("{s:s}", "group", closed));
    }
    if (exceptions) {
        (void)json_array_append_new(special, json_pack("{s:s}", "group", exceptions));
    }
    return json_pack("{s:s, s:s, s:o, s:o}", "token", schedule->token, "zone", schedule->zone,
                     "weekly", weekly, "special_days", special);
}

static json_t *calendar_json(const struct ics_calendar *calendar)
{
    json_t *groups = json_array(), *schedules = json_array();
    const char *closed = calendar->closed.n == 0 ? NULL
                         : calendar->name[0]     ? calendar->name
                                                 : "holidays";
    bool sound = true;
    if (closed) {
        (void)json_array_append_new(groups, group_json(closed, &calendar->closed));
    }
    for (int i = 0; sound && i < calendar->n_schedules; i++) {
        const struct ics_schedule *schedule = &calendar->schedules[i];
        char exceptions[ICS_NAME_SIZE + 16];
        (void)snprintf(exceptions, sizeof exceptions, "%s exceptions", schedule->token);
        sound = check_exceptions(calendar, schedule);
        if (schedule->exceptions.n > 0) {
            (void)json_array_append_new(groups, group_json(exceptions, &schedule->exceptions));
        }
        (void)json_array_append_new(
            schedules,
            schedule_json(schedule, closed, schedule->exceptions.n > 0 ? exceptions : NULL));
    }
    json_t *document = json_pack("{s:o, s:o}", "special_day_groups", groups, "schedules",
                                 schedules);
    if (!sound) {
        json_decref(document);
        return NULL;
    }
    return document;
}

/* ---- the calendar ---- */

/* The name of the calendar: NAME (RFC 7986), or X-WR-CALNAME as many programs write it. */
static void read_name(struct ics_calendar *calendar, icalcomponent *root)
{
    for (icalproperty *property = icalcomponent_get_first_property(root, ICAL_ANY_PROPERTY);
         property; property = icalcomponent_get_next_property(root, ICAL_ANY_PROPERTY)) {
        const char *name = icalproperty_get_property_name(property);
        const char *value = icalproperty_get_value_as_string(property);
        if (name && value &&
            (strcasecmp(name, "NAME") == 0 || strcasecmp(name, "X-WR-CALNAME") == 0)) {
            (void)snprintf(calendar->name, sizeof calendar->name, "%s", value);
        }
    }
}

static bool read_events(struct ics_calendar *calendar, icalcomponent *root)
{
    int n = 0;
    for (icalcomponent *component = icalcomponent_get_first_component(root, ICAL_VEVENT_COMPONENT);
         component; component = icalcomponent_get_next_component(root, ICAL_VEVENT_COMPONENT)) {
        struct ics_event event = {.calendar = calendar, .component = component};
        const char *summary = icalcomponent_get_summary(component);
        n++;
        if (summary && summary[0]) {
            (void)snprintf(event.name, sizeof event.name, "%s", summary);
        } else {
            (void)snprintf(event.name, sizeof event.name, "number %d", n);
        }
        if (!ics_add_event(&event)) {
            return false;
        }
    }
    if (calendar->n_schedules == 0 && calendar->closed.n == 0) {
        (void)reader_refuse(calendar->line, "the calendar has no events");
        return false;
    }
    return true;
}

static json_t *read_root(struct ics_calendar *calendar, icalcomponent *root)
{
    if (!root || icalcomponent_isa(root) != ICAL_VCALENDAR_COMPONENT) {
        return reader_refuse(calendar->line, "it is not one iCalendar object (VCALENDAR)");
    }
    read_name(calendar, root);
    return read_events(calendar, root) ? calendar_json(calendar) : NULL;
}

json_t *reader_ics(const char *text, size_t size, const char *zone, int today,
                   struct reader_line *line)
{
    (void)size; /* the text ends with its only zero byte */
    struct ics_calendar calendar = {
        .zone = zone,
        .today = today,
        .schedules = calloc(ICS_SCHEDULES_MAX, sizeof *calendar.schedules),
        .line = line};
    if (!calendar.schedules) {
        return reader_refuse(line, "there is no memory");
    }
    icalerror_set_errors_are_fatal(0);
    icalcomponent *root = icalparser_parse_string(text);
    json_t *document = read_root(&calendar, root);
    if (root) {
        icalcomponent_free(root);
    }
    free(calendar.schedules);
    return document;
}
