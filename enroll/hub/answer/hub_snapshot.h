/* Snapshots of zones, as the database keeps them. Internal to the answers. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_SNAPSHOT_H
#define ISO_ENROLL_HUB_ANSWER_HUB_SNAPSHOT_H

#include "enroll/hub/answer/hub_answer.h"

/* Makes a snapshot if there is none of the zone's epoch that is at most HUB_SNAPSHOT_AGE_MAX deltas
 * old and after which all deltas are there. */
int hub__snapshot_ensure(struct hub_store *store, const struct iso_fleet_id *zone,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes the newest snapshot of the zone's epoch. -ENODATA there is none. */
int hub__snapshot_write(struct hub_store *store, const struct iso_fleet_id *zone,
                        int (*write)(void *context, const void *bytes, size_t size), void *context,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
