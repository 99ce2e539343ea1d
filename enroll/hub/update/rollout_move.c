/* A rollout moves on, with a question of one of its doors or without. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/update/step_parts.h"

enum { PAUSE_S = 300 }; /* a longer time without a count: the hub, or the database, was away */

int hub__step_lock(struct hub__step *s, bool *is_locked, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &s->rollout);
    const int error = hub_db_run_often(s->store->db,
                                       "SELECT state, stage, most, stop_after, wait_s, counted_s, "
                                       "watched_s, clock_s FROM rollout WHERE id = $1 FOR NO KEY "
                                       "UPDATE SKIP LOCKED",
                                       &values, &rows, fault);
    *is_locked = !error && PQntuples(rows) > 0;
    if (*is_locked) {
        hub__rollout_stage_row(rows, 0, 0, &s->stage);
        s->counted_s = hub_row_integer(rows, 0, 5);
        s->watched_s = hub_row_integer(rows, 0, 6);
        s->clock_s = hub_row_integer(rows, 0, 7);
    }
    PQclear(rows);
    return error;
}

static int store_stage(const struct hub__step *s, const struct hub_rollout_count *count,
                       const char *why, struct iso_fault *fault)
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
    hub_value_integer(&values, s->clock_s);
    return hub_db_run_often(s->store->db,
                            "UPDATE rollout SET state = $2, why = CASE WHEN $3 = '' THEN why ELSE "
                            "$3 END, stage = $4, most = $5, told = $6, counted_s = $7, "
                            "watched_s = $8, clock_s = $9 WHERE id = $1",
                            &values, NULL, fault);
}

static int record(const struct hub__step *s, const char *what,
                  const struct hub_rollout_count *count, struct iso_fault *fault)
{
    return hub__act_add(s->store, what, s->zone, NULL,
                        json_pack("{s:s,s:I,s:I,s:I}", "version", s->version, "stage",
                                  (json_int_t)s->stage.stage, "told", (json_int_t)count->told,
                                  "failed", (json_int_t)count->failed),
                        fault);
}

int hub__step_reopen(struct hub__step *s, bool *is_open, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &s->rollout);
    hub_value_integer(&values, s->store->now_s());
    hub_value_id(&values, s->door);
    int error = hub_db_run_often(
        s->store->db,
        "UPDATE rollout r SET state = 'running', counted_s = $2, watched_s = $2 WHERE id = $1 "
        "AND state = 'done' AND NOT EXISTS (SELECT FROM rollout n WHERE n.zone = r.zone "
        "AND n.id <> r.id AND (n.started_s >= r.started_s OR n.state IN ('running', 'stopped'))) "
        "AND EXISTS (SELECT FROM door_zone z WHERE z.zone = r.zone AND z.door = $3)",
        &values, &rows, fault);
    *is_open = !error && hub_db_changed(rows) > 0;
    PQclear(rows);
    if (*is_open) {
        s->stage.state = HUB_ROLLOUT_RUNNING;
        s->counted_s = s->watched_s = s->store->now_s();
        error = hub__act_add(s->store, "update-again", s->zone, NULL,
                             json_pack("{s:s}", "version", s->version), fault);
    }
    return error;
}

/* The clock of the rollout goes on, unless the hub was away or the rollout does not run. */
static void pass_time(struct hub__step *s)
{
    const int64_t passed_s = s->store->now_s() - s->counted_s;
    if (passed_s > PAUSE_S) {
        s->watched_s = s->store->now_s();
    } else if (passed_s > 0 && s->stage.state == HUB_ROLLOUT_RUNNING) {
        s->clock_s += passed_s;
    }
}

int hub__step_move(struct hub__step *s, struct iso_fault *fault)
{
    const struct hub_rollout_stage before = s->stage;
    struct hub_rollout_count count;
    char why[96] = "";
    pass_time(s);
    int error = hub__rollout_leave_out_expelled(s->store, &s->rollout, fault);
    if (!error && s->stage.state == HUB_ROLLOUT_RUNNING) { /* a stopped one waits for nobody */
        error = hub__rollout_fail_late(s->store, &s->rollout, s->watched_s, s->clock_s, fault);
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
        error = hub__step_store(s, HUB__DOOR_TOLD, true, "", fault);
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

/* ---- without a question ---- */

static int look_at_one(void *context, struct iso_fault *fault)
{
    struct hub__step *s = context;
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
        error = hub__step_lock(s, &is_locked, fault);
    }
    PQclear(rows);
    return error || !is_locked || s->stage.state != HUB_ROLLOUT_RUNNING ? error
                                                                        : hub__step_move(s, fault);
}

int hub_rollouts_look(struct hub_store *store, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run_often(store->db, "SELECT id FROM rollout WHERE state = 'running'", NULL,
                                 &rows, fault);
    const int n = error ? 0 : PQntuples(rows);
    for (int i = 0; i < n && error != -ENOTCONN; i++) {
        struct hub__step s = {
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
