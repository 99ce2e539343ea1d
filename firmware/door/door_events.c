#include "firmware/door/door_events.h"

#include <inttypes.h>
#include <stdio.h>

#include "drivers/base/times.h"

static const char *const names[ISO_DOOR_SOURCES] = {
    [ISO_DOOR_BY_CONTACT] = "contact",
    [ISO_DOOR_BY_TAMPER] = "tamper switch",
    [ISO_DOOR_BY_EXIT_BUTTON] = "exit button",
    [ISO_DOOR_BY_FAULT] = "fault",
};

/* Returns ISO_DOOR_SOURCES for an event whose records are not limited. */
static enum iso_door_source source_of(enum iso_door_event cause)
{
    switch (cause) {
    case ISO_DOOR_ON_OPENED:
    case ISO_DOOR_ON_CLOSED:
        return ISO_DOOR_BY_CONTACT;
    case ISO_DOOR_ON_TAMPER:
    case ISO_DOOR_ON_TAMPER_ENDED:
        return ISO_DOOR_BY_TAMPER;
    case ISO_DOOR_ON_EXIT_BUTTON:
        return ISO_DOOR_BY_EXIT_BUTTON;
    case ISO_DOOR_ON_FAULT:
    case ISO_DOOR_ON_RECOVERED:
        return ISO_DOOR_BY_FAULT;
    default:
        return ISO_DOOR_SOURCES;
    }
}

bool iso_door_events_take(struct iso_door_events *events, const struct iso_door_news *news,
                          int64_t now_ns)
{
    const enum iso_door_source source = source_of(news->cause);
    events->newest = *news;
    if (source == ISO_DOOR_SOURCES) {
        return true;
    }
    events->causes[source] = news->cause;
    return iso_event_limit_take(&events->limits[source], now_ns);
}

static void describe(const struct iso_door_events *events, enum iso_door_source source,
                     const struct iso_event_report *report, struct iso_door_burst *out)
{
    const struct iso_door_news *newest = &events->newest;
    out->cause = events->causes[source];
    out->state = newest->state;
    (void)snprintf(out->text, sizeof out->text, "%s changed %" PRIu64 " times in %.1f s; now %s%s",
                   names[source], report->events, (double)report->length_ns / (double)ISO_NS_PER_S,
                   iso_door_state_name(newest->state), newest->tamper ? ", housing open" : "");
}

bool iso_door_events_next(struct iso_door_events *events, bool ending, int64_t now_ns,
                          struct iso_door_burst *out)
{
    struct iso_event_report report;
    for (int i = 0; i < ISO_DOOR_SOURCES; i++) {
        if (iso_event_limit_report(&events->limits[i], ending, now_ns, &report)) {
            describe(events, (enum iso_door_source)i, &report, out);
            return true;
        }
    }
    return false;
}

int64_t iso_door_events_due_ns(const struct iso_door_events *events)
{
    int64_t due_ns = ISO_NEVER_NS;
    for (int i = 0; i < ISO_DOOR_SOURCES; i++) {
        const int64_t own_ns = iso_event_limit_due_ns(&events->limits[i]);
        due_ns = own_ns < due_ns ? own_ns : due_ns;
    }
    return due_ns;
}
