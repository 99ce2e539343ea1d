/* Removes the bounces of a switch by the times of its edges. Pure.
 *
 * A new level counts when it has lasted for the window; a shorter one is ignored. Since each edge
 * has the time at which it happened, it does not matter when the edges are read: a press of 100 ms
 * that is over by then still counts. With a window of 0 every edge counts. */
#ifndef ISO_DRIVERS_DOOR_DEBOUNCE_H
#define ISO_DRIVERS_DOOR_DEBOUNCE_H

#include <stdbool.h>
#include <stdint.h>

struct iso_debounce {
    int64_t window_ns;
    bool level;           /* without bounces */
    bool was_active;      /* `level` was active since the last iso_debounce_take */
    bool raw;             /* the level of the wire */
    int64_t raw_since_ns; /* since when the wire has that level */
};

/* The first level counts without a delay. */
void iso_debounce_init(struct iso_debounce *debounce, int64_t window_ns, bool level,
                       int64_t now_ns);

/* Notes that the wire has changed to a level. Edges are given in the order of their times; an edge
 * with an earlier time than the last one gets the time of the last one. */
void iso_debounce_edge(struct iso_debounce *debounce, bool level, int64_t t_ns);

/* Notes that time has passed without another edge. */
void iso_debounce_advance(struct iso_debounce *debounce, int64_t now_ns);

/* When iso_debounce_advance will change the level; INT64_MAX if no change is pending. */
int64_t iso_debounce_due_ns(const struct iso_debounce *debounce);

/* Whether the level is active now or was active since the last call. */
bool iso_debounce_take(struct iso_debounce *debounce);

#endif
