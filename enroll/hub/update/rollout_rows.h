/* Rows of the tables of updates. Internal to enroll/hub/update. */
#ifndef ISO_ENROLL_HUB_UPDATE_ROLLOUT_ROWS_H
#define ISO_ENROLL_HUB_UPDATE_ROLLOUT_ROWS_H

#include "enroll/hub/update/hub_update.h"

/* States of a door, in the order in which they are shown: what needs attention comes first. */
enum hub__door_state {
    HUB__DOOR_FAILED,
    HUB__DOOR_WENT_BACK,
    HUB__DOOR_TOLD,
    HUB__DOOR_FETCHING,
    HUB__DOOR_INSTALLED,
    HUB__DOOR_WAITING,
    HUB__DOOR_UNABLE,
    HUB__DOOR_HEALTHY,
    HUB__DOOR_STATES
};

const char *hub__door_state_word(enum hub__door_state state);

/* HUB__DOOR_WAITING for a word that is none; the table has no others. */
enum hub__door_state hub__door_state_read(const char *word);

/* Five columns from `column` on: state, stage, most, stop_after, wait_s. */
void hub__rollout_stage_row(const PGresult *rows, int row, int column,
                            struct hub_rollout_stage *out);

/* The columns version, board, size, sha256, added_s. -EIO the digest has another length. */
int hub__update_file_row(const PGresult *rows, int row, struct hub_update_file *out,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Counts the doors of a rollout. */
int hub__rollout_count(struct hub_store *store, const struct iso_fleet_id *rollout,
                       struct hub_rollout_count *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A door that is expelled takes no part any more. */
int hub__rollout_leave_out_expelled(struct hub_store *store, const struct iso_fleet_id *rollout,
                                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* Doors that were told have failed if they are silent, say nothing of their updates, or were at
 * work for too long (hub_update.h). `watched_s`: since when the hub looks; `clock_s`: of the
 * rollout, which stands still while it is stopped or the hub is away. */
int hub__rollout_fail_late(struct hub_store *store, const struct iso_fleet_id *rollout,
                           int64_t watched_s, int64_t clock_s, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
