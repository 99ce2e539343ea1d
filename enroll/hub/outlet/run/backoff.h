/* How long an outlet waits after failures. Pure. */
#ifndef ISO_ENROLL_HUB_OUTLET_RUN_BACKOFF_H
#define ISO_ENROLL_HUB_OUTLET_RUN_BACKOFF_H

#include <stdbool.h>
#include <stdint.h>

enum { HUB__BACKOFF_FIRST_MS = 1000, HUB__BACKOFF_MOST_MS = 300000 };

/* After the `failures`th failure in a row (1 or more): twice as long after each, at most
 * HUB__BACKOFF_MOST_MS; of this at least a half, the rest by `random`, so that hubs whose receiver
 * comes back do not all call it at once. Not shorter than `asked_s`, for which the receiver asked
 * (0: it did not), but of this at most an hour. */
int64_t hub__backoff_ms(uint64_t failures, int64_t asked_s, uint32_t random);

/* Whether this failure is worth a line: the first one, and each power of two. */
bool hub__backoff_says(uint64_t failures);

#endif
