/* Special day groups and schedules. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/policy/calendar.h"
#include "firmware/policy/document/day_text.h"
#include "firmware/policy/document/reader.h"

static int compare_days(const void *a, const void *b)
{
    const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

int iso__read_group(struct iso__reader *reader, const json_t *object, void *record)
{
    struct iso_special_day_group *group = record;
    const json_t *days = NULL;
    const int error = iso__reader_list(reader, object, "days", ISO_SPECIAL_DAYS_MAX, &days);
    if (error != 0) {
        return error;
    }
    size_t i;
    json_t *day;
    json_array_foreach(days, i, day)
    {
        const char *text = json_string_value(day);
        if (!text || iso_date_read(text, &group->days[i]) != 0) {
            return iso__reader_refuse(reader, "\"%.*s\" is not a date such as \"2026-12-25\"",
                                      iso__quoted(text), text ? text : "");
        }
        group->n++;
    }
    qsort(group->days, group->n, sizeof *group->days, compare_days);
    for (int d = 1; d < group->n; d++) {
        if (group->days[d] == group->days[d - 1]) {
            char text[ISO_DATE_TEXT_SIZE];
            iso_date_write(group->days[d], text);
            return iso__reader_refuse(reader, "has the date \"%s\" twice", text);
        }
    }
    return 0;
}

/* Reads the periods of a day; `day` names it. */
static int read_hours(const struct iso__reader *reader, const char *day, const json_t *list,
                      struct iso_day_hours *hours)
{
    if (!json_is_array(list)) {
        return iso__reader_refuse(reader, "%.*s: the hours are not an array", iso__quoted(day),
                                  day);
    }
    if (json_array_size(list) > ISO_PERIODS_MAX) {
        return iso__reader_refuse(reader, "%.*s: %zu periods, at most %d", iso__quoted(day), day,
                                  json_array_size(list), ISO_PERIODS_MAX);
    }
    size_t i;
    json_t *period;
    json_array_foreach(list, i, period)
    {
        const char *text = json_string_value(period);
        if (!text || iso_period_read(text, &hours->periods[i]) != 0) {
            return iso__reader_refuse(reader,
                                      "%.*s: \"%.*s\" is not a period such as \"09:00-17:30\"",
                                      iso__quoted(day), day, iso__quoted(text), text ? text : "");
        }
        hours->n++;
    }
    return 0;
}

static int read_weekly(const struct iso__reader *reader, const json_t *weekly,
                       struct iso_schedule *schedule)
{
    if (!weekly) {
        return 0;
    }
    if (!json_is_object(weekly)) {
        return iso__reader_refuse(reader, "\"weekly\" is not an object");
    }
    unsigned named = 0;
    const char *text;
    json_t *list;
    json_object_foreach((json_t *)weekly, text, list)
    {
        const unsigned days = iso_days_read(text);
        struct iso_day_hours hours = {0};
        if (days == 0) {
            return iso__reader_refuse(
                reader, "\"%.*s\" is neither a day nor days such as \"monday-friday\"",
                iso__quoted(text), text);
        }
        if ((named & days) != 0) {
            return iso__reader_refuse(reader, "\"%.*s\" names a day for the second time",
                                      iso__quoted(text), text);
        }
        const int error = read_hours(reader, text, list, &hours);
        if (error != 0) {
            return error;
        }
        named |= days;
        for (int day = 0; day < ISO_WEEKDAYS; day++) {
            if ((days >> day & 1) != 0) {
                schedule->weekly[day] = hours;
            }
        }
    }
    return 0;
}

static int read_special_days(const struct iso__reader *reader, const json_t *object,
                             struct iso_schedule *schedule)
{
    static const char *const members[] = {"group", "hours", NULL};
    const json_t *list = NULL;
    int error = iso__reader_list(reader, object, "special_days", ISO_SPECIAL_SCHEDULES_MAX, &list);
    if (error != 0) {
        return error;
    }
    size_t i;
    json_t *part;
    json_array_foreach(list, i, part)
    {
        struct iso_special_hours *special = &schedule->special[schedule->n_special];
        const json_t *hours = json_object_get(part, "hours");
        error = iso__reader_members(reader, "an entry of \"special_days\"", part, members);
        error = error != 0 ? error
                           : iso__reader_reference(reader, part, "group", ISO__GROUP, true,
                                                   &special->group);
        if (error == 0 && hours) {
            error = read_hours(reader,
                               iso__document_token(reader->document, ISO__GROUP, special->group),
                               hours, &special->hours);
        }
        if (error != 0) {
            return error;
        }
        schedule->n_special++;
    }
    return 0;
}

/* Finds the zone among those that were read, or reads it. */
static int find_zone(struct iso__reader *reader, const char *name, uint16_t *out)
{
    struct iso_policy_document *document = reader->document;
    const uint16_t n = document->policy.n_zones;
    for (uint16_t i = 0; i < n; i++) {
        if (strcmp(document->zones[i].name, name) == 0) {
            *out = i;
            return 0;
        }
    }
    if (strlen(name) >= ISO_ZONE_NAME_SIZE) {
        return iso__reader_refuse(reader, "the name of the zone is too long");
    }
    struct iso_zone *grown = reallocarray(document->zones, (size_t)n + 1, sizeof *grown);
    if (!grown) {
        return iso__reader_no_memory(reader);
    }
    document->zones = grown;
    memset(&grown[n], 0, sizeof *grown);
    struct iso_fault why = {0};
    const int error = reader->zones->read(reader->zones->context, name, &grown[n], &why);
    if (error == -ENOMEM) {
        return iso__reader_no_memory(reader);
    }
    if (error != 0) {
        return iso__reader_refuse(reader, "the zone cannot be read: %s", why.text);
    }
    document->policy.n_zones++;
    *out = n;
    return 0;
}

int iso__read_schedule(struct iso__reader *reader, const json_t *object, void *record)
{
    struct iso_schedule *schedule = record;
    const char *zone = NULL;
    int error = iso__reader_text(reader, object, "zone", &zone);
    if (error == 0 && !zone) {
        error = iso__reader_refuse(reader, "has no \"zone\"");
    }
    error = error != 0 ? error : read_weekly(reader, json_object_get(object, "weekly"), schedule);
    error = error != 0 ? error : read_special_days(reader, object, schedule);
    return error != 0 ? error : find_zone(reader, zone, &schedule->zone);
}
