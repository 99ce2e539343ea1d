/* The records of all doors' logs. The errors of hub_store.h. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_EVENT_H
#define ISO_ENROLL_HUB_ANSWER_HUB_EVENT_H

#include "enroll/hub/store/hub_store.h"

struct hub_event {
    struct iso_fleet_id door;
    const char *door_name;
    uint64_t number;
    const char *time;   /* as the door wrote it: "2026-11-21T08:30:15.250Z", or "" */
    const char *record; /* JSON */
};

/* The place of a record in the order of all of them. */
struct hub_event_place {
    struct iso_fleet_id door;
    uint64_t number;
    const char *time;
};

struct hub_event_filter {
    const struct iso_fleet_id *door; /* NULL: all */
    const char *person, *event;      /* NULL: all */
    const char *since; /* of this time on, in the form of a record's time; NULL: all */
    uint32_t most;     /* the newest ones; 0: all */
    const char *until; /* before this time; NULL: all */
    const struct hub_event_place *before; /* only older ones than this: the next page; NULL: all */
};

/* Records in the order of their times; those of the same time in the order of their numbers. */
int hub_event_each(struct hub_store *store, const struct hub_event_filter *filter,
                   int (*each)(void *context, const struct hub_event *event), void *context,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
