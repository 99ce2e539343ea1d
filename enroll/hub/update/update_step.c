#include "enroll/hub/update/update_step.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/update/rollout_rows.h"

enum {
    COUNT_EVERY_S = 10, /* doors that only wait need not be counted with each question */
    PAUSE_S = 300,      /* a longer time without a count: the hub, or the database, was away */
};

struct step {
    struct hub_store *store;
    const struct iso_fleet_id *door;
    struct iso_fleet_update_report report;
    /* Of the database. */
    struct iso_fleet_id rollout;
    char version[ISO_FLEET_UPDATE_WORD_SIZE], zone[HUB_NAME_SIZE];
    char board[ISO_FLEET_UPDATE_WORD_SIZE]; /* that the door had when it was told; "": it was not */
    struct hub_rollout_stage stage;
    int64_t told, counted_s, watched_s;
    int64_t doors; /* that were told or wait; 0: not counted now */
    enum hub__door_state state;
    bool counts, stuck;
    int64_t mute_s; /* since when it says nothing of its updates; 0: it does */
    char why[ISO_FLEET_UPDATE_FAULT_SIZE];
    struct hub_update_file file; /* for the board of the door; size 0: there is none */
};

/* Finds the rollout in which a door takes part: the one that runs, if there are several. */
static int find(struct step *s, bool *found, struct iso_fault *fault)
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
        "r.state IN ('running', 'stopped') ORDER BY r.state, r.started_s DESC LIMIT 1",
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

static int find_file(struct step *s, struct iso_fault *fault)
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

/* ---- what the report says ---- */

static enum hub__door_state state_of_report(enum iso_fleet_update_state state,
                                            enum hub__door_state before)
{
    switch (state) {
    case ISO_FLEET_UPDATE_FETCHING:
    case ISO_FLEET_UPDATE_INSTALLING:
        return HUB__DOOR_FETCHING;
    case ISO_FLEET_UPDATE_INSTALLED:
        return HUB__DOOR_INSTALLED;
    case ISO_FLEET_UPDATE_FAILED:
        return HUB__DOOR_FAILED;
    case ISO_FLEET_UPDATE_WENT_BACK:
        return HUB__DOOR_WENT_BACK;
    default:
        return before;
    }
}

/* A door that was told restarts, and its first question may come before it knows its state. If it
 * goes on to say nothing, it fails (rollout_late.c). */
static bool is_mute(const struct step *s)
{
    return s->counts && (!s->report.is_known || s->report.state == ISO_FLEET_UPDATE_NONE);
}

/* The state of the door by what it says, and why it is unable, is late or has failed. */
static enum hub__door_state new_state(const struct step *s, const char **why)
{
    const struct iso_fleet_update_report *report = &s->report;
    const bool is_this = iso_fleet_id_is_same(&report->rollout, &s->rollout);
    *why = s->why;
    if (is_mute(s)) {
        return s->state;
    }
    *why = "";
    if (!report->is_known) {
        *why = "its release does not know updates by the hub";
        return HUB__DOOR_UNABLE;
    }
    if (report->state == ISO_FLEET_UPDATE_NONE) {
        *why = "this machine takes no updates";
        return HUB__DOOR_UNABLE;
    }
    if (strcmp(report->version, s->version) == 0 &&
        (report->state == ISO_FLEET_UPDATE_HEALTHY || report->state == ISO_FLEET_UPDATE_IDLE)) {
        return HUB__DOOR_HEALTHY;
    }
    /* It would begin the same again, and its stage would never end. */
    if (s->stuck) {
        *why = s->why;
        return HUB__DOOR_FAILED;
    }
    if (is_this && report->state != ISO_FLEET_UPDATE_HEALTHY &&
        report->state != ISO_FLEET_UPDATE_IDLE) {
        *why = report->fault;
        return state_of_report(report->state, s->state);
    }
    if (s->file.size == 0) {
        *why = "the hub has no file of this version for its board";
        return HUB__DOOR_UNABLE;
    }
    if (s->state == HUB__DOOR_UNABLE) {
        return HUB__DOOR_WAITING;
    }
    if (s->state == HUB__DOOR_FAILED && s->counts) { /* it was silent, and reports again */
        return HUB__DOOR_TOLD;
    }
    *why = s->why;
    return s->state;
}

static int store_state(const struct step *s, enum hub__door_state state, bool counts,
                       const char *why, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &s->rollout);
    hub_value_id(&values, s->door);
    hub_value_text(&values, hub__door_state_word(state));
    hub_value_switch(&values, counts);
    hub_value_integer(&values, s->store->now_s());
    hub_value_text(&values, why);
    hub_value_text(&values, s->file.board); /* "" without a file */
    hub_value_integer(&values, s->mute_s);
    /* A door that says something else of the same state has not moved. */
    return hub_db_run_often(s->store->db,
                            "UPDATE rollout_door SET changed_s = CASE WHEN state = $3 THEN "
                            "changed_s ELSE $5 END, state = $3, counts = $4, fault = $6, "
                            "board = $7, mute_s = $8, stuck = stuck AND $3 = 'failed' "
                            "WHERE rollout = $1 AND door = $2",
                            &values, NULL, fault);
}

/* ---- the rollout ---- */

/* While this lock is held, nobody else tells doors of the rollout. The transaction has locked rows
 * of doors before. So nobody waits for this lock, because two hubs could then wait for each other:
 * whoever does not get it leaves the rollout as it is, and the door asks again within a minute.
 * (Commands that begin, stop or remove lock the table; they have locked no rows of doors.) */
static int lock(struct step *s, bool *is_locked, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &s->rollout);
    const int error = hub_db_run_often(s->store->db,
                                       "SELECT state, stage, most, stop_after, wait_s, counted_s, "
                                       "watched_s FROM rollout WHERE id = $1 FOR NO KEY UPDATE "
                                       "SKIP LOCKED",
                                       &values, &rows, fault);
    *is_locked = !error && PQntuples(rows) > 0;
    if (*is_locked) {
        hub__rollout_stage_row(rows, 0, 0, &s->stage);
        s->counted_s = hub_row_integer(rows, 0, 5);
        s->watched_s = hub_row_integer(rows, 0, 6);
    }
    PQclear(rows);
    return error;
}

static int store_stage(const struct step *s, const struct hub_rollout_count *count, const char *why,
                       struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &s->rollout);
    hub_value_text(&values, hub_rollout_state_word(s->stage.state));
    hub_value_text(&values, why);
    hub_value_integer(&values, s->stage.stage);
    hub_value_integer(&values, s->stage.most);
    hub_value_integer(&values, count->told);
    hub_value_integer(&values, s->store->now_s());
    hub_value_integer(&values, s->watched_s);
    return hub_db_run_often(s->store->db,
                            "UPDATE rollout SET state = $2, why = CASE WHEN $3 = '' THEN why ELSE "
                            "$3 END, stage = $4, most = $5, told = $6, counted_s = $7, "
                            "watched_s = $8 WHERE id = $1",
                            &values, NULL, fault);
}

static int record(const struct step *s, const char *what, const struct hub_rollout_count *count,
                  struct iso_fault *fault)
{
    return hub__act_add(s->store, what, s->zone, NULL,
                        json_pack("{s:s,s:I,s:I,s:I}", "version", s->version, "stage",
                                  (json_int_t)s->stage.stage, "told", (json_int_t)count->told,
                                  "failed", (json_int_t)count->failed),
                        fault);
}

/* Counts the doors, moves the stage on, and tells this door if it is its turn. */
static int move(struct step *s, struct iso_fault *fault)
{
    const struct hub_rollout_stage before = s->stage;
    struct hub_rollout_count count;
    char why[96] = "";
    if (s->store->now_s() - s->counted_s > PAUSE_S) {
        s->watched_s = s->store->now_s();
    }
    int error = hub__rollout_leave_out_expelled(s->store, &s->rollout, fault);
    if (!error && s->stage.state == HUB_ROLLOUT_RUNNING) { /* a stopped one waits for nobody */
        error = hub__rollout_fail_late(s->store, &s->rollout, s->watched_s, fault);
    }
    error = error ? error : hub__rollout_count(s->store, &s->rollout, &count, fault);
    if (error) {
        return error;
    }
    s->doors = count.told + count.waiting;
    hub_rollout_move(&s->stage, &count, s->store->now_s());
    const bool is_told = s->stage.state == HUB_ROLLOUT_RUNNING && s->state == HUB__DOOR_WAITING &&
                         count.told < s->stage.most;
    if (is_told) {
        error = store_state(s, HUB__DOOR_TOLD, true, "", fault);
        s->state = HUB__DOOR_TOLD;
        count.told++;
    }
    if (!error && s->stage.state != before.state) {
        error = record(s, s->stage.state == HUB_ROLLOUT_STOPPED ? "update-stopped" : "update-done",
                       &count, fault);
        if (s->stage.state == HUB_ROLLOUT_STOPPED) {
            (void)snprintf(why, sizeof why, "%lld of %lld doors have failed",
                           (long long)count.failed, (long long)count.told);
        }
    } else if (!error && s->stage.stage != before.stage) {
        error = record(s, "update-stage", &count, fault);
    }
    return error ? error : store_stage(s, &count, why, fault);
}

/* Whether the door says something that is not stored. */
static bool says_more(const struct step *s, enum hub__door_state state, const char *why)
{
    return state != s->state || strcmp(why, s->why) != 0 || is_mute(s) != (s->mute_s > 0);
}

/* Whether something is to be written. */
static bool is_due(const struct step *s, enum hub__door_state state, const char *why)
{
    return says_more(s, state, why) ||
           (s->stage.state == HUB_ROLLOUT_RUNNING && state == HUB__DOOR_WAITING &&
            s->told < s->stage.most) ||
           s->store->now_s() - s->counted_s >= COUNT_EVERY_S;
}

/* Stores what the door says, and moves the rollout on. */
static int take_state(struct step *s, struct iso_fault *fault)
{
    const char *why = "";
    const enum hub__door_state state = new_state(s, &why);
    bool is_locked = false;
    if (!is_due(s, state, why)) {
        return 0;
    }
    int error = lock(s, &is_locked, fault);
    if (error || !is_locked) {
        return error;
    }
    if (says_more(s, state, why)) {
        s->mute_s = is_mute(s) ? s->store->now_s() : 0;
        /* A door that was not told counts if it acts by an order whose record was lost. */
        const bool counts = s->counts || state == HUB__DOOR_FETCHING ||
                            state == HUB__DOOR_INSTALLED;
        error = store_state(s, state, counts && state != HUB__DOOR_UNABLE, why, fault);
        s->state = state;
    }
    return error ? error : move(s, fault);
}

static void write_order(const struct step *s, bool *is_ordered, struct iso_fleet_update *order)
{
    *is_ordered = s->stage.state == HUB_ROLLOUT_RUNNING && s->file.size > 0 &&
                  (s->state == HUB__DOOR_TOLD || s->state == HUB__DOOR_FETCHING ||
                   s->state == HUB__DOOR_INSTALLED);
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
    struct step s = {.store = store, .door = door};
    bool found = false;
    *is_ordered = false;
    int error = find(&s, &found, fault);
    if (error || !found) {
        return error;
    }
    hub__update_report_read(health, &s.report);
    error = find_file(&s, fault);
    if (error) {
        return error;
    }
    error = take_state(&s, fault);
    if (!error) {
        write_order(&s, is_ordered, order);
    }
    return error;
}

/* ---- without a question ---- */

static int look_at_one(void *context, struct iso_fault *fault)
{
    struct step *s = context;
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    bool is_locked = false;
    hub_value_id(&values, &s->rollout);
    int error = hub_db_run_often(s->store->db,
                                 "SELECT r.version, z.name FROM rollout r JOIN zone z "
                                 "ON z.id = r.zone WHERE r.id = $1",
                                 &values, &rows, fault);
    if (!error && PQntuples(rows) > 0) {
        (void)snprintf(s->version, sizeof s->version, "%s", hub_row_text(rows, 0, 0));
        (void)snprintf(s->zone, sizeof s->zone, "%s", hub_row_text(rows, 0, 1));
        error = lock(s, &is_locked, fault);
    }
    PQclear(rows);
    return error || !is_locked || s->stage.state != HUB_ROLLOUT_RUNNING ? error : move(s, fault);
}

int hub_rollouts_look(struct hub_store *store, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run_often(store->db, "SELECT id FROM rollout WHERE state = 'running'", NULL,
                                 &rows, fault);
    const int n = error ? 0 : PQntuples(rows);
    for (int i = 0; i < n && error != -ENOTCONN; i++) {
        struct step s = {
            .store = store, .rollout = hub_row_id(rows, i, 0), .state = HUB__DOOR_HEALTHY};
        struct iso_fault own = {.text = ""};
        const int r = hub_db_transaction(store->db, HUB_READ_COMMITTED, look_at_one, &s, &own);
        if (r && !error && fault) {
            *fault = own;
        }
        error = r == -ENOTCONN || !error ? r : error;
    }
    PQclear(rows);
    return error;
}
