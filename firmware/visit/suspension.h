/* Finds out how long the machine has been suspended. It uses two clocks, of which only one runs
 * during a suspension.
 *
 * Frames have the time of the monotonic clock, which stops during a suspension. A frame that was
 * exposed before the suspension therefore looks fresh after it. Reading the clocks before each
 * frame shows that the machine was suspended, and from which moment on frames are new. */
#ifndef ISO_FIRMWARE_VISIT_SUSPENSION_H
#define ISO_FIRMWARE_VISIT_SUSPENSION_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/base/times.h"

struct iso_suspension {
    int64_t asleep_ns; /* total: boot time minus monotonic time */
    int64_t awake_ns;  /* frames exposed before this monotonic time may be older than the last
                          suspension */
};

/* Begins with no known suspension. */
void iso_suspension_init(struct iso_suspension *suspension, const struct iso_times *times);

/* Reads the clocks. Returns true if the machine has been suspended since the last call. Suspensions
 * of less than 10 ms do not count. */
bool iso_suspension_look(struct iso_suspension *suspension, const struct iso_times *times);

#endif
