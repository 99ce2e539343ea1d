/* Decides which changes of the door are reported one by one, and which are only counted. An input
 * that chatters (a wet contact, a loose wire, somebody who plays with the exit button) makes
 * hundreds of changes in a second. Pure: time is an argument.
 *
 * Changes caused by the contact, the tamper switch, the exit button and faults are limited, each
 * kind separately (event_limit.h). All others are reported: they come from decisions and from
 * times of the door.
 *
 * The times of changes that are only counted, and the states between them, are lost. The first
 * changes of a burst are kept, and of the others their number, how long they took, and the state
 * after them. */
#ifndef ISO_FIRMWARE_DOOR_DOOR_EVENTS_H
#define ISO_FIRMWARE_DOOR_DOOR_EVENTS_H

#include "firmware/door/door_guard.h"
#include "firmware/door/event_limit.h"

enum iso_door_source {
    ISO_DOOR_BY_CONTACT,
    ISO_DOOR_BY_TAMPER,
    ISO_DOOR_BY_EXIT_BUTTON,
    ISO_DOOR_BY_FAULT,
    ISO_DOOR_SOURCES
};

/* All zero: nothing has happened yet. */
struct iso_door_events {
    struct iso_event_limit limits[ISO_DOOR_SOURCES];
    enum iso_door_event causes[ISO_DOOR_SOURCES]; /* cause of the newest change from each source */
    struct iso_door_news newest;                  /* the newest change of all */
};

/* The report of changes that were only counted. */
struct iso_door_burst {
    enum iso_door_event cause; /* cause of the last of them */
    enum iso_door_state state; /* present state of the door */
    char text[96];             /* "contact changed 212 times in 10.0 s; now locked" */
};

/* Handles a change. Returns true if it is reported by itself. */
bool iso_door_events_take(struct iso_door_events *events, const struct iso_door_news *news,
                          int64_t now_ns);

/* Returns a report of counted changes that is due now; false: there are no more. `ending`: all
 * counted changes are due. Call it until it returns false, before iso_door_events_take and when
 * something is due. */
bool iso_door_events_next(struct iso_door_events *events, bool ending, int64_t now_ns,
                          struct iso_door_burst *out);

/* The time at which iso_door_events_next has to be called again; ISO_NEVER_NS if nothing was
 * counted. */
int64_t iso_door_events_due_ns(const struct iso_door_events *events);

#endif
