#include "enroll/hub/update/update_step.h"

#include <stdio.h>
#include <string.h>

#include "enroll/hub/update/step_parts.h"

enum { COUNT_EVERY_S = 10 }; /* doors that only wait need not be counted with each question */

/* Finds the rollout in which a door takes part: the one that runs, if there are several; or else
 * one that is stopped, or its last one that is done. */
static int find(struct hub__step *s, bool *found, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, s->door);
    const int error = hub_db_run_often(
        s->store->db,
        "SELECT r.id, r.version, z.name, r.state, r.stage, r.most, r.stop_after, r.wait_s, "
        "r.told, r.counted_s, r.watched_s, d.state, d.counts, d.board, d.stuck, d.mute_s, d.fault "
        "FROM rollout_door d "
        "JOIN rollout r ON r.id = d.rollout JOIN zone z ON z.id = r.zone WHERE d.door = $1 AND "
        "r.state IN ('running', 'stopped', 'done') ORDER BY r.state = 'done', r.state, "
        "r.started_s DESC LIMIT 1",
        &values, &rows, fault);
    *found = !error && PQntuples(rows) > 0;
    if (*found) {
        s->rollout = hub_row_id(rows, 0, 0);
        (void)snprintf(s->version, sizeof s->version, "%s", hub_row_text(rows, 0, 1));
        (void)snprintf(s->zone, sizeof s->zone, "%s", hub_row_text(rows, 0, 2));
        hub__rollout_stage_row(rows, 0, 3, &s->stage);
        s->told = hub_row_integer(rows, 0, 8);
        s->counted_s = hub_row_integer(rows, 0, 9);
        s->watched_s = hub_row_integer(rows, 0, 10);
        s->state = hub__door_state_read(hub_row_text(rows, 0, 11));
        s->counts = hub_row_switch(rows, 0, 12);
        (void)snprintf(s->board, sizeof s->board, "%s", hub_row_text(rows, 0, 13));
        s->stuck = hub_row_switch(rows, 0, 14);
        s->mute_s = hub_row_integer(rows, 0, 15);
        iso_fleet_update_fault_copy(s->why, hub_row_text(rows, 0, 16));
    }
    PQclear(rows);
    return error;
}

static int find_file(struct hub__step *s, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_text(&values, s->version);
    /* After a restart a door asks before it knows its board. */
    hub_value_text(&values, *s->report.board ? s->report.board : s->board);
    int error = hub_db_run_often(s->store->db,
                                 "SELECT version, board, size, sha256, added_s FROM update_file "
                                 "WHERE version = $1 AND board = $2",
                                 &values, &rows, fault);
    if (!error && PQntuples(rows) > 0) {
        error = hub__update_file_row(rows, 0, &s->file, fault);
    }
    PQclear(rows);
    return error;
}

/* Whether the door says something that is not stored. */
static bool says_more(const struct hub__step *s, enum hub__door_state state, const char *why)
{
    return state != s->state || strcmp(why, s->why) != 0 || hub__step_is_mute(s) != (s->mute_s > 0);
}

/* Whether something is to be written. */
static bool is_due(const struct hub__step *s, enum hub__door_state state, const char *why)
{
    return says_more(s, state, why) ||
           (s->stage.state == HUB_ROLLOUT_RUNNING && state == HUB__DOOR_WAITING &&
            s->told < s->stage.most) ||
           s->store->now_s() - s->counted_s >= COUNT_EVERY_S;
}

/* Stores what the door says, and moves the rollout on. */
static int take_state(struct hub__step *s, struct iso_fault *fault)
{
    const char *why = "";
    const enum hub__door_state state = hub__step_state(s, &why);
    bool is_locked = false;
    if (!is_due(s, state, why)) {
        return 0;
    }
    int error = hub__step_lock(s, &is_locked, fault);
    if (error || !is_locked) {
        return error;
    }
    if (says_more(s, state, why)) {
        s->mute_s = hub__step_is_mute(s) ? s->store->now_s() : 0;
        /* A door that was not told counts if it acts by an order whose record was lost. */
        const bool counts = s->counts || state == HUB__DOOR_FETCHING ||
                            state == HUB__DOOR_INSTALLED;
        error = hub__step_store(s, state, counts && state != HUB__DOOR_UNABLE, why, fault);
        s->state = state;
    }
    return error ? error : hub__step_move(s, fault);
}

static bool is_at_work(enum hub__door_state state)
{
    return state == HUB__DOOR_TOLD || state == HUB__DOOR_FETCHING || state == HUB__DOOR_INSTALLED;
}

/* Most questions of doors whose rollout is done: there is nothing to ask the database for. */
static bool is_over(const struct hub__step *s)
{
    if (s->stage.state != HUB_ROLLOUT_DONE) {
        return false;
    }
    return s->state == HUB__DOOR_HEALTHY
               ? s->report.state != ISO_FLEET_UPDATE_WENT_BACK ||
                     !iso_fleet_id_is_same(&s->report.rollout, &s->rollout)
               : s->state != HUB__DOOR_FAILED && s->state != HUB__DOOR_WENT_BACK;
}

/* A rollout that is done: a door that was silent comes back and is told, so that the rollout runs
 * again, or a door says at last what became of it. */
static int take_late(struct hub__step *s, struct iso_fault *fault)
{
    const char *why = "";
    const enum hub__door_state state = hub__step_state(s, &why);
    bool is_locked = false, is_open = true;
    if (state == s->state || state == HUB__DOOR_WAITING || state == HUB__DOOR_UNABLE) {
        return 0;
    }
    int error = hub__step_lock(s, &is_locked, fault);
    if (!error && is_locked && is_at_work(state) && s->stage.state == HUB_ROLLOUT_DONE) {
        error = hub__step_reopen(s, &is_open, fault);
    }
    if (error || !is_locked || !is_open) {
        return error;
    }
    s->mute_s = 0;
    error = hub__step_store(s, state, s->counts, why, fault);
    s->state = state;
    return error || s->stage.state == HUB_ROLLOUT_DONE ? error : hub__step_move(s, fault);
}

static void write_order(const struct hub__step *s, bool *is_ordered, struct iso_fleet_update *order)
{
    *is_ordered = s->stage.state == HUB_ROLLOUT_RUNNING && s->file.size > 0 && is_at_work(s->state);
    if (*is_ordered) {
        *order = (struct iso_fleet_update){
            .door = *s->door,
            .rollout = s->rollout,
            .size = s->file.size,
            .spread_s = hub_rollout_spread_s(&s->stage, s->doors ? s->doors : s->told,
                                             s->file.size),
        };
        memcpy(order->sha256, s->file.sha256, sizeof order->sha256);
        memcpy(order->version, s->file.version, sizeof order->version);
        memcpy(order->board, s->file.board, sizeof order->board);
    }
}

int hub__update_step(struct hub_store *store, const struct iso_fleet_id *door, const char *health,
                     bool *is_ordered, struct iso_fleet_update *order, struct iso_fault *fault)
{
    struct hub__step s = {.store = store, .door = door};
    bool found = false;
    *is_ordered = false;
    int error = find(&s, &found, fault);
    if (error || !found) {
        return error;
    }
    hub__update_report_read(health, &s.report);
    if (is_over(&s)) {
        return 0;
    }
    error = find_file(&s, fault);
    if (error) {
        return error;
    }
    error = s.stage.state == HUB_ROLLOUT_DONE ? take_late(&s, fault) : take_state(&s, fault);
    if (!error) {
        write_order(&s, is_ordered, order);
    }
    return error;
}
