/* Whether a sensor is stuck, which means that it delivers earlier frames again. Pure.
 *
 *   FREE    three repeated frames in a row; one may look like another by chance   -> STUCK
 *   STUCK   fifteen new frames in a row (half a second of 30 frames a second)     -> FREE
 *
 * The two numbers differ, so that a stream in which new and repeated frames alternate does not
 * begin and end a fault with each of them. A repeated frame proves nothing in either state. */
#ifndef ISO_FIRMWARE_VISIT_REPEAT_WATCH_H
#define ISO_FIRMWARE_VISIT_REPEAT_WATCH_H

#include <stdbool.h>

enum { ISO_REPEATS_TO_STUCK = 3, ISO_NEW_TO_FREE = 15 };

/* All zero: FREE, and no frame was counted. */
struct iso_repeat_watch {
    bool stuck;
    int run; /* number of consecutive frames that contradict the state */
};

/* Handles a usable frame. Returns true if the state has changed. */
bool iso_repeat_watch_take(struct iso_repeat_watch *watch, bool repeats);

#endif
