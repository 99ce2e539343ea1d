/* What a door of the check does with the reports of its appliance: it keeps the last visit, and
 * wakes the link. */
#ifndef TESTS_FLEET_CHECK_EVENTS_H
#define TESTS_FLEET_CHECK_EVENTS_H

#include "firmware/appliance/appliance.h"
#include "firmware/fleet/link/link.h"

struct check_heard {
    const char *folder;     /* of the door, for lines */
    struct link_door *link; /* NULL: there is none */
    char visit[300];        /* the last one: "allow NAME", "deny REASON"; "": none */
};

/* The handlers, for an appliance. `heard` outlives it. Lines for the system's log are printed if
 * FLEET_DOORS_LOUD is in the environment. */
struct iso_appliance_events check_events(struct check_heard *heard);

#endif
