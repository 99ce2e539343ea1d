/* The keys of a new epoch for all doors of a zone, some at a time. Internal to the outbox. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_OUTBOX_KEYS_H
#define ISO_ENROLL_HUB_ANSWER_HUB_OUTBOX_KEYS_H

#include "enroll/hub/answer/hub_outbox.h"

/* Emits KEY for the next HUB_OUTBOX_KEYS doors of the zone that have not reported the epoch of its
 * place. *done says that these were the last ones; then the outbox forgets the zone. A
 * door that does not get its key asks for it. */
int hub__outbox_keys(struct hub_store *store, const struct iso_fleet_place *place,
                     const struct hub_emit *emit, struct hub_outbox *outbox, bool *done,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
