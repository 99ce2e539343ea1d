/* What the QUESTION of a door does to its rollout, and whether the door gets an order with the
 * answer. Internal to the answers: it is a part of the transaction that stores the report. */
#ifndef ISO_ENROLL_HUB_UPDATE_UPDATE_STEP_H
#define ISO_ENROLL_HUB_UPDATE_UPDATE_STEP_H

#include "enroll/hub/update/hub_update.h"

/* Reads the members of a health, which may be "" or lack some of them. */
void hub__update_report_read(const char *health, struct iso_fleet_update_report *out);

/* Stores the report, moves the rollout on, and sets *is_ordered and the order (but for its door) if
 * the door shall install something. Without a rollout of the door nothing is written. */
int hub__update_step(struct hub_store *store, const struct iso_fleet_id *door, const char *health,
                     bool *is_ordered, struct iso_fleet_update *order, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
