/* The level of a switch without its bounces, by the times of its edges: pure.
 *
 * A new level counts when it has lasted for the window; what is shorter has not happened. Since the
 * edges bear the times at which they happened, it makes no difference how late they are looked at:
 * a press of 100 ms that is over when somebody looks is still a press. A window of 0 takes every
 * edge for one. */
#ifndef ISO_DRIVERS_DOOR_DEBOUNCE_H
#define ISO_DRIVERS_DOOR_DEBOUNCE_H

#include <stdbool.h>
#include <stdint.h>

struct iso_debounce {
    int64_t window_ns;
    bool level;           /* what counts */
    bool was_active;      /* it has been active since the last iso_debounce_take */
    bool raw;             /* the wire */
    int64_t raw_since_ns; /* when it took that level */
};

/* The level at the beginning counts at once. */
void iso_debounce_init(struct iso_debounce *debounce, int64_t window_ns, bool level,
                       int64_t now_ns);

/* The wire has taken a level. Edges come in the order of their times; one that claims to be earlier
 * than the last is taken to be simultaneous with it. */
void iso_debounce_edge(struct iso_debounce *debounce, bool level, int64_t t_ns);

/* Time has passed without another edge. */
void iso_debounce_advance(struct iso_debounce *debounce, int64_t now_ns);

/* When iso_debounce_advance will change the level; INT64_MAX if nothing is under way. */
int64_t iso_debounce_due_ns(const struct iso_debounce *debounce);

/* Whether it is active or has been since the last call. */
bool iso_debounce_take(struct iso_debounce *debounce);

#endif
