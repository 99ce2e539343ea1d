/* Compares the time that a grant needs with the allowed age of its frames: when the lock is
 * switched, the person was seen at most stale_ms ago. Pure.
 *
 *   needed = frames that agree x period of the sensor
 *            + the longest wait for the record of the grant
 *            + working time of a frame, from its exposure until its face is extracted and judged
 *
 * If the sum comes close to stale_ms, a grant can become a refusal ("stale") in a busy moment. The
 * working time does not include the comparison with the gallery. It is a mean over usable frames,
 * in which a new one counts for a sixteenth; it is 0 until there is one. */
#ifndef ISO_FIRMWARE_VISIT_STALE_BUDGET_H
#define ISO_FIRMWARE_VISIT_STALE_BUDGET_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"

/* The longest wait for the record of a grant. */
enum { ISO_GRANT_WAIT_MS = 250 };

struct iso_stale_budget {
    int64_t stale_ns;
    int agree;      /* number of frames that have to agree, 1 or more */
    double rate_hz; /* nominal rate of the sensor; 0: not known, and its period is left out */
    int64_t work_ns;
    bool measured; /* work_ns comes from one frame at least */
};

/* Adds the working time of a usable frame. */
void iso_stale_budget_measure(struct iso_stale_budget *budget, int64_t took_ns);

/* The needed time, as above. */
int64_t iso_stale_budget_needed_ns(const struct iso_stale_budget *budget);

/* Whether the needed time is more than four fifths of stale_ns. Then sets a fault of one line. */
bool iso_stale_budget_is_tight(const struct iso_stale_budget *budget, struct iso_fault *fault);

#endif
