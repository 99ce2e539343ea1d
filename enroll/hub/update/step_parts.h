/* The parts of a step (update_step.h). Internal to enroll/hub/update. */
#ifndef ISO_ENROLL_HUB_UPDATE_STEP_PARTS_H
#define ISO_ENROLL_HUB_UPDATE_STEP_PARTS_H

#include "enroll/hub/update/rollout_rows.h"
#include "enroll/hub/update/update_step.h"

/* A rollout, and the door that asks; without a question only the rollout. */
struct hub__step {
    struct hub_store *store;
    const struct iso_fleet_id *door;
    struct iso_fleet_update_report report;
    /* Of the database. */
    struct iso_fleet_id rollout;
    char version[ISO_FLEET_UPDATE_WORD_SIZE], zone[HUB_NAME_SIZE];
    char board[ISO_FLEET_UPDATE_WORD_SIZE]; /* that the door had when it was told; "": it was not */
    struct hub_rollout_stage stage;
    int64_t told, counted_s, watched_s;
    int64_t clock_s; /* of the rollout: for how long it ran, and the hub looked at it */
    int64_t doors;   /* that were told or wait; 0: not counted now */
    enum hub__door_state state;
    bool counts, stuck;
    int64_t mute_s; /* since when it says nothing of its updates; 0: it does */
    char why[ISO_FLEET_UPDATE_FAULT_SIZE];
    struct hub_update_file file; /* for the board of the door; size 0: there is none */
};

/* ---- step_state.c ---- */

/* Whether a door that was told says nothing of its updates. It restarts, and its first question may
 * come before it knows its state. If it goes on to say nothing, it fails (rollout_late.c). */
bool hub__step_is_mute(const struct hub__step *s);

/* The state of the door by what it says, and why it is unable, is late or has failed; *why belongs
 * to `s`, or is constant. */
enum hub__door_state hub__step_state(const struct hub__step *s, const char **why);

/* Stores a state of the door. The rollout is locked. */
int hub__step_store(const struct hub__step *s, enum hub__door_state state, bool counts,
                    const char *why, struct iso_fault *fault) __attribute__((warn_unused_result));

/* ---- rollout_move.c ---- */

/* While this lock is held, nobody else tells doors of the rollout. The transaction has locked rows
 * of doors before. So nobody waits for this lock, because two hubs could then wait for each other:
 * whoever does not get it leaves the rollout as it is, and the door asks again within a minute.
 * (Commands that begin, stop or remove lock the table; they have locked no rows of doors.) Reads
 * the stage again. */
int hub__step_lock(struct hub__step *s, bool *is_locked, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Lets a rollout that is done run again for a door that comes back. *is_open receives false if the
 * zone has had a later rollout, or if the door has left the zone. The caller has locked the
 * rollout. */
int hub__step_reopen(struct hub__step *s, bool *is_open, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Counts the doors, moves the stage on, and tells this door if it is its turn. The rollout is
 * locked. */
int hub__step_move(struct hub__step *s, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
