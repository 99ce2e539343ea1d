/* Whether a sensor is stuck: it delivers frames again that it delivered before. Pure.
 *
 *   FREE    three repeated frames in a row; one may look like another by chance   -> STUCK
 *   STUCK   fifteen new frames in a row (half a second of 30 frames a second)     -> FREE
 *
 * The two differ so that a stream of new and repeated frames in turns does not begin and end a
 * fault with each of them. A repeated frame is evidence of nothing in either state. */
#ifndef ISO_FIRMWARE_VISIT_REPEAT_WATCH_H
#define ISO_FIRMWARE_VISIT_REPEAT_WATCH_H

#include <stdbool.h>

enum { ISO_REPEATS_TO_STUCK = 3, ISO_NEW_TO_FREE = 15 };

/* All zero: FREE, and nothing has been seen. */
struct iso_repeat_watch {
    bool stuck;
    int run; /* frames in a row that speak against the state */
};

/* Takes a usable frame in. True: the state has changed. */
bool iso_repeat_watch_take(struct iso_repeat_watch *watch, bool repeats);

#endif
