/* What the database need not keep. The leader calls this now and then; each call deletes a bounded
 * number of rows, so that others do not wait. The errors of hub_store.h.
 *
 * - Deltas that the broker has, that a snapshot of the zone's epoch contains, and that every door
 * of the zone has confirmed or that are older than so many days. A door that comes back below them
 *   fetches the snapshot. Their digests stay, 48 bytes each, so that a door of another history is
 *   noticed as before (hub_question.c).
 * - Events that were stored before so many days, by the clock of the database, because the clock of
 *   a door may be wrong. They are personal data. What is not acknowledged to the door yet stays,
 *   because the acknowledgement is counted from the rows.
 * - Acts, the same way; the newest one stays. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_PRUNE_H
#define ISO_ENROLL_HUB_ANSWER_HUB_PRUNE_H

#include "enroll/hub/store/hub_store.h"

enum { HUB_PRUNE_AT_ONCE = 1000 };

/* Days; 0: for ever. */
struct hub_prune_days {
    uint32_t deltas, events, acts;
};

struct hub_pruned {
    uint64_t deltas, events, acts;
};

/* Deletes at most HUB_PRUNE_AT_ONCE rows of each kind. *out: how many; fewer mean that nothing is
 * left of the kind. */
int hub_prune(struct hub_store *store, const struct hub_prune_days *days, struct hub_pruned *out,
              struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
