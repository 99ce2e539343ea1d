/* Finds out how long the machine has been suspended, from two clocks of which only one goes on
 * during a suspension.
 *
 * Frames bear the time of the monotonic clock, which stands still during a suspension: a frame
 * that was exposed before it looks fresh after it. A look at the clocks before each frame shows
 * that the machine was suspended, and from which moment on frames are new. */
#ifndef ISO_FIRMWARE_VISIT_SUSPENSION_H
#define ISO_FIRMWARE_VISIT_SUSPENSION_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/base/times.h"

struct iso_suspension {
    int64_t asleep_ns; /* in total: boot time minus monotonic time */
    int64_t awake_ns;  /* frames exposed before this monotonic time may be from before the last
                          suspension */
};

/* No suspension is known of. */
void iso_suspension_init(struct iso_suspension *suspension, const struct iso_times *times);

/* Looks at the clocks. True: the machine has been suspended since the last look. Suspensions of
 * less than 10 ms are no suspensions. */
bool iso_suspension_look(struct iso_suspension *suspension, const struct iso_times *times);

#endif
