/* Rollouts and their doors, for people. */
#include <errno.h>
#include <stdio.h>

#include "enroll/hub/store/hub_zone.h"
#include "enroll/hub/update/rollout_rows.h"

static void read_rollout(const PGresult *rows, int row, struct hub_rollout *out)
{
    *out = (struct hub_rollout){
        .id = hub_row_id(rows, row, 0),
        .why = hub_row_text(rows, row, 8),
        .started_s = hub_row_integer(rows, row, 9),
        .doors = hub_row_integer(rows, row, 10),
        .healthy = hub_row_integer(rows, row, 11),
        .unable = hub_row_integer(rows, row, 12),
    };
    (void)snprintf(out->version, sizeof out->version, "%s", hub_row_text(rows, row, 1));
    (void)snprintf(out->zone, sizeof out->zone, "%s", hub_row_text(rows, row, 2));
    hub__rollout_stage_row(rows, row, 3, &out->stage);
}

int hub_rollout_each(struct hub_store *store,
                     int (*each)(void *context, const struct hub_rollout *rollout), void *context,
                     struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(
        store->db,
        "SELECT r.id, r.version, z.name, r.state, r.stage, r.most, r.stop_after, r.wait_s, r.why, "
        "r.started_s, d.n, d.healthy, d.unable FROM rollout r JOIN zone z ON z.id = r.zone, "
        "LATERAL (SELECT count(*) AS n, count(*) FILTER (WHERE state = 'healthy') AS healthy, "
        "count(*) FILTER (WHERE state = 'unable') AS unable FROM rollout_door WHERE rollout = "
        "r.id) "
        "d ORDER BY r.started_s, z.name",
        NULL, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct hub_rollout rollout;
        read_rollout(rows, i, &rollout);
        error = hub__rollout_count(store, &rollout.id, &rollout.count, fault);
        error = error ? error : each(context, &rollout);
    }
    PQclear(rows);
    return error;
}

/* The newest rollout of a zone. */
static int find_newest(struct hub_store *store, const struct hub_zone *zone,
                       struct iso_fleet_id *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &zone->place.zone);
    int error = hub_db_run(store->db,
                           "SELECT id FROM rollout WHERE zone = $1 ORDER BY state IN ('running', "
                           "'stopped') DESC, started_s DESC LIMIT 1",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "zone %s has had no rollout", zone->name);
    }
    if (!error) {
        *out = hub_row_id(rows, 0, 0);
    }
    PQclear(rows);
    return error;
}

int hub_rollout_doors(struct hub_store *store, const char *zone_name,
                      int (*each)(void *context, const struct hub_rollout_door *door),
                      void *context, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    struct hub_zone zone;
    struct iso_fleet_id id;
    int error = hub_zone_find(store, zone_name, &zone, fault);
    error = error ? error : find_newest(store, &zone, &id, fault);
    if (error) {
        return error;
    }
    hub_value_id(&values, &id);
    error = hub_db_run(store->db,
                       "SELECT door.name, d.state, CASE WHEN d.fault = '' AND d.mute_s > 0 AND "
                       "d.state IN ('told', 'fetching', 'installed') THEN 'it says nothing of its "
                       "updates' ELSE d.fault END, d.changed_s, door.reported_s FROM "
                       "rollout_door d JOIN door ON door.id = d.door WHERE d.rollout = $1 ORDER BY "
                       "array_position(ARRAY['failed', 'went-back', 'told', 'fetching', "
                       "'installed', 'waiting', 'unable', 'healthy'], d.state), door.name",
                       &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct hub_rollout_door door = {
            .name = hub_row_text(rows, i, 0),
            .state = hub_row_text(rows, i, 1),
            .fault = hub_row_text(rows, i, 2),
            .changed_s = hub_row_integer(rows, i, 3),
            .reported_s = hub_row_integer(rows, i, 4),
        };
        error = each(context, &door);
    }
    PQclear(rows);
    return error;
}
