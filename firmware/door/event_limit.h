/* Limits how many records one source of events makes: a contact that chatters must not fill the
 * log. Pure: time is an argument.
 *
 *   PASSING  the first ISO_EVENT_LIMIT_BURST events of a second pass, each by itself
 *            one more in that second                                        -> FOLDING
 *   FOLDING  events are counted, and nothing else is kept of them
 *            ten seconds of it: a report, and counting begins anew          -> FOLDING
 *            a second without an event: a report, if anything was counted   -> PASSING */
#ifndef ISO_FIRMWARE_DOOR_EVENT_LIMIT_H
#define ISO_FIRMWARE_DOOR_EVENT_LIMIT_H

#include <stdbool.h>
#include <stdint.h>

enum { ISO_EVENT_LIMIT_BURST = 5 };

/* All zero: PASSING, and nothing has happened yet. */
struct iso_event_limit {
    int64_t second_ns; /* when the present second began */
    int passed;        /* events that have passed in it */
    bool folding;
    uint64_t folded;   /* since the last report */
    int64_t since_ns;  /* when the counting began */
    int64_t newest_ns; /* the newest event that was counted */
};

/* How many events were counted within which time. */
struct iso_event_report {
    uint64_t events;
    int64_t length_ns;
};

/* Handles an event. True: it passes. False: it was counted. */
bool iso_event_limit_take(struct iso_event_limit *limit, int64_t now_ns);

/* Makes the report that is due. Returns true, with the report in *out, if events were counted for
 * it. `ending`: all counted events are due. Call it before iso_event_limit_take with the same time,
 * and at iso_event_limit_due_ns. */
bool iso_event_limit_report(struct iso_event_limit *limit, bool ending, int64_t now_ns,
                            struct iso_event_report *out);

/* The time at which iso_event_limit_report has to be called; ISO_NEVER_NS in PASSING. */
int64_t iso_event_limit_due_ns(const struct iso_event_limit *limit);

#endif
