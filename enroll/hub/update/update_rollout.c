/* Rollouts begin, stop and go on. */
#include <errno.h>
#include <string.h>

#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/store/hub_zone.h"
#include "enroll/hub/update/rollout_rows.h"

struct work {
    struct hub_store *store;
    const struct hub_rollout_options *options;
    struct hub_zone zone;
    struct iso_fleet_id id;
};

/* Runs a statement that selects a name, and refuses with a fault if it finds one. */
static int refuse_if(const struct work *w, const char *sql, const struct hub_values *values,
                     const char *why, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(w->store->db, sql, values, &rows, fault);
    if (!error && PQntuples(rows) > 0) {
        error = iso_fault_set(fault, -EALREADY, "%s %s; stop it first", why,
                              hub_row_text(rows, 0, 0));
    }
    PQclear(rows);
    return error;
}

static int check_version(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_text(&values, w->options->version);
    int error = hub_db_run(w->store->db, "SELECT count(*) FROM update_file WHERE version = $1",
                           &values, &rows, fault);
    if (!error && hub_row_integer(rows, 0, 0) == 0) {
        error = iso_fault_set(fault, -ENOENT, "there is no update of version %s",
                              w->options->version);
    }
    PQclear(rows);
    return error;
}

/* No door may be told two versions. */
static int check_free(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->zone.place.zone);
    int error = refuse_if(w, "SELECT version FROM rollout WHERE zone = $1 AND state = 'running'",
                          &values, "the zone is on the way to version", fault);
    return error ? error
                 : refuse_if(w,
                             "SELECT z.name FROM rollout r JOIN zone z ON z.id = r.zone "
                             "JOIN rollout_door d ON d.rollout = r.id JOIN door_zone m "
                             "ON m.door = d.door WHERE m.zone = $1 AND r.state = 'running' LIMIT 1",
                             &values, "doors of the zone take part in the rollout of zone", fault);
}

static int insert(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0}, zone = {.n = 0};
    hub_value_id(&zone, &w->zone.place.zone);
    const int error = hub_db_run(w->store->db,
                                 "UPDATE rollout SET state = 'replaced' WHERE zone = $1 AND "
                                 "state = 'stopped'",
                                 &zone, NULL, fault);
    if (error) {
        return error;
    }
    hub_value_id(&values, &w->id);
    hub_value_text(&values, w->options->version);
    hub_value_id(&values, &w->zone.place.zone);
    hub_value_integer(&values, w->options->first);
    hub_value_integer(&values, w->options->stop_after);
    hub_value_integer(&values, w->options->wait_s);
    hub_value_integer(&values, w->store->now_s());
    return hub_db_run(w->store->db,
                      "INSERT INTO rollout (id, version, zone, state, most, stop_after, wait_s, "
                      "started_s, counted_s, watched_s) "
                      "VALUES ($1, $2, $3, 'running', $4, $5, $6, $7, $7, $7)",
                      &values, NULL, fault);
}

static int insert_doors(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &w->id);
    hub_value_id(&values, &w->zone.place.zone);
    hub_value_integer(&values, w->store->now_s());
    int error = hub_db_run(
        w->store->db,
        "INSERT INTO rollout_door (rollout, door, changed_s) SELECT $1, door.id, "
        "$3 FROM door JOIN door_zone z ON z.door = door.id WHERE z.zone = $2 AND "
        "door.joined_s > 0 AND door.expelled_s = 0",
        &values, &rows, fault);
    if (!error && hub_db_changed(rows) == 0) {
        error = iso_fault_set(fault, -ENODATA, "no door of zone %s has joined", w->zone.name);
    }
    PQclear(rows);
    return error;
}

static int start(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    const struct hub_rollout_options *o = w->options;
    int error = hub_db_script(w->store->db, "LOCK TABLE rollout IN EXCLUSIVE MODE", fault);
    error = error ? error : check_version(w, fault);
    error = error ? error : hub_zone_find(w->store, o->zone, &w->zone, fault);
    error = error ? error : check_free(w, fault);
    error = error ? error : insert(w, fault);
    error = error ? error : insert_doors(w, fault);
    return error ? error
                 : hub__act_add(w->store, "update-roll", w->zone.name, NULL,
                                json_pack("{s:s,s:I,s:I,s:I}", "version", o->version, "first",
                                          (json_int_t)o->first, "stop-after",
                                          (json_int_t)o->stop_after, "wait", (json_int_t)o->wait_s),
                                fault);
}

int hub_rollout_start(struct hub_store *store, const struct hub_rollout_options *options,
                      struct iso_fault *fault)
{
    struct work w = {.store = store, .options = options, .id = iso_fleet_id_random()};
    if (options->first == 0) {
        return iso_fault_set(fault, -EINVAL, "a rollout begins with at least one door");
    }
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, start, &w, fault);
}

/* ---- stop and resume ---- */

struct turn {
    struct hub_store *store;
    const char *zone, *from, *sql, *act, *unfit;
    const struct iso_fleet_id *id; /* which one is meant; NULL: whichever it is */
    bool begins;                   /* it must still be possible, as at its start */
};

static int check_again(const struct turn *t, const struct hub_zone *zone, const char *version,
                       struct iso_fault *fault)
{
    const struct hub_rollout_options options = {.version = version};
    const struct work w = {.store = t->store, .options = &options, .zone = *zone};
    const int error = check_version(&w, fault);
    return error ? error : check_free(&w, fault);
}

/* Runs the statement for the rollout of the zone that has the state `from`; its $1 is the id, its
 * $2 the actor, its $3 the time. */
static int turn(void *context, struct iso_fault *fault)
{
    const struct turn *t = context;
    struct hub_zone zone;
    struct hub_values find = {.n = 0}, values = {.n = 0};
    PGresult *rows = NULL;
    int error = hub_db_script(t->store->db, "LOCK TABLE rollout IN EXCLUSIVE MODE", fault);
    error = error ? error : hub_zone_find(t->store, t->zone, &zone, fault);
    if (error) {
        return error;
    }
    hub_value_id(&find, &zone.place.zone);
    hub_value_text(&find, t->from);
    error = hub_db_run(t->store->db,
                       "SELECT id, version FROM rollout WHERE zone = $1 AND state = $2 "
                       "FOR NO KEY UPDATE",
                       &find, &rows, fault);
    if (!error && PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -EALREADY, "zone %s has no rollout that %s", zone.name,
                              t->unfit);
    }
    if (!error && t->id) {
        const struct iso_fleet_id found = hub_row_id(rows, 0, 0);
        error = iso_fleet_id_is_same(&found, t->id)
                    ? 0
                    : iso_fault_set(fault, -ESRCH, "zone %s has another rollout now", zone.name);
    }
    if (!error && t->begins) {
        error = check_again(t, &zone, hub_row_text(rows, 0, 1), fault);
    }
    if (!error) {
        const struct iso_fleet_id id = hub_row_id(rows, 0, 0);
        hub_value_id(&values, &id);
        hub_value_text(&values, t->store->actor);
        hub_value_integer(&values, t->store->now_s());
        error = hub_db_run(t->store->db, t->sql, &values, NULL, fault);
    }
    error = error ? error
                  : hub__act_add(t->store, t->act, zone.name, NULL,
                                 json_pack("{s:s}", "version", hub_row_text(rows, 0, 1)), fault);
    PQclear(rows);
    return error;
}

int hub_rollout_stop(struct hub_store *store, const char *zone, const struct iso_fleet_id *id,
                     struct iso_fault *fault)
{
    struct turn t = {
        .store = store,
        .zone = zone,
        .id = id,
        .from = "running",
        .sql = "UPDATE rollout SET state = 'stopped', why = 'by ' || $2, watched_s = $3 "
               "WHERE id = $1",
        .act = "update-stop",
        .unfit = "is running",
    };
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, turn, &t, fault);
}

int hub_rollout_resume(struct hub_store *store, const char *zone, const struct iso_fleet_id *id,
                       struct iso_fault *fault)
{
    struct turn t = {
        .store = store,
        .zone = zone,
        .id = id,
        .from = "stopped",
        /* The hub has not waited for its doors meanwhile. */
        .sql = "WITH d AS (UPDATE rollout_door SET counts = false WHERE rollout = $1 AND state IN "
               "('failed', 'went-back')) UPDATE rollout SET state = 'running', why = '', "
               "watched_s = $3, counted_s = $3 WHERE id = $1 AND $2 <> ''",
        .act = "update-resume",
        .unfit = "was stopped",
        .begins = true,
    };
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, turn, &t, fault);
}
