#include "enroll/hub/answer/hub_prune.h"

#include "enroll/hub/answer/hub_snapshot.h"

enum { DAY_S = 86400 };

/* Deltas up to the place that the broker has and the newest snapshot of the epoch contains. The row
 * of the zone need not be locked: both only grow within an epoch, and a new snapshot takes the
 * place of the old one in one transaction. $1 limits the rows, $2 is the age in seconds. */
static const char prune_deltas[] =
    "WITH bound AS (SELECT z.id, least(z.published, coalesce((SELECT max(s.sequence) "
    "FROM snapshot s WHERE s.zone = z.id AND s.epoch = z.epoch), 0)) AS most, (SELECT min(CASE "
    "WHEN p.epoch = z.epoch "
    "THEN p.sequence ELSE 0 END) FROM door_zone dz JOIN door d ON d.id = dz.door "
    "AND d.joined_s > 0 AND d.expelled_s = 0 LEFT JOIN door_place p ON p.door = d.id "
    "AND p.zone = z.id WHERE dz.zone = z.id) AS confirmed FROM zone z WHERE NOT z.behind), "
    "old AS (SELECT x.zone, x.sequence FROM bound b JOIN delta x ON x.zone = b.id "
    "AND x.sequence <= b.most AND (x.sequence <= coalesce(b.confirmed, 0) "
    "OR ($2 > 0 AND x.made_s < extract(epoch FROM now())::bigint - $2)) LIMIT $1), "
    "gone AS (DELETE FROM delta x USING old o WHERE x.zone = o.zone AND x.sequence = o.sequence "
    "RETURNING x.zone, x.sequence, x.digest) "
    "INSERT INTO delta_digest (zone, sequence, digest) SELECT zone, sequence, digest FROM gone "
    "ON CONFLICT (zone, sequence) DO UPDATE SET digest = EXCLUDED.digest";

static const char prune_events[] =
    "DELETE FROM event e USING (SELECT x.door, x.number FROM event x JOIN door d ON d.id = x.door "
    "WHERE x.stored_s < extract(epoch FROM now())::bigint - $2 AND x.number <= d.acked LIMIT $1) o "
    "WHERE e.door = o.door AND e.number = o.number";

static const char prune_acts[] =
    "DELETE FROM act WHERE number IN (SELECT number FROM act WHERE time_s < "
    "extract(epoch FROM now())::bigint - $2 AND number < (SELECT max(number) FROM act) LIMIT $1)";

static int prune(struct hub_store *store, const char *sql, uint32_t days, uint64_t *out,
                 struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *result = NULL;
    hub_value_integer(&values, HUB_PRUNE_AT_ONCE);
    hub_value_integer(&values, (int64_t)days * DAY_S);
    const int error = hub_db_run(store->db, sql, &values, &result, fault);
    *out = error ? 0 : (uint64_t)hub_db_changed(result);
    PQclear(result);
    return error;
}

/* The zones with many deltas behind their snapshot, or without one: a new snapshot lets them be
 * pruned. One at a time, because it takes long. */
static int renew_snapshot(struct hub_store *store, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_integer(&values, HUB_SNAPSHOT_AGE_MAX);
    int error = hub_db_run(store->db,
                           "SELECT z.id FROM zone z WHERE NOT z.behind AND z.sequence - "
                           "coalesce((SELECT max(s.sequence) FROM snapshot s WHERE s.zone = z.id "
                           "AND s.epoch = z.epoch), 0) > $1 AND (SELECT count(*) FROM delta d "
                           "WHERE d.zone = z.id) > $1 LIMIT 1",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) > 0) {
        const struct iso_fleet_id zone = hub_row_id(rows, 0, 0);
        error = hub__snapshot_ensure(store, &zone, fault);
    }
    PQclear(rows);
    return error;
}

int hub_prune(struct hub_store *store, const struct hub_prune_days *days, struct hub_pruned *out,
              struct iso_fault *fault)
{
    struct hub_pruned pruned = {.deltas = 0};
    int error = days->deltas ? renew_snapshot(store, fault) : 0;
    if (!error && days->deltas) {
        error = prune(store, prune_deltas, days->deltas, &pruned.deltas, fault);
    }
    if (!error && days->events) {
        error = prune(store, prune_events, days->events, &pruned.events, fault);
    }
    if (!error && days->acts) {
        error = prune(store, prune_acts, days->acts, &pruned.acts, fault);
    }
    if (!error) {
        *out = pruned;
    }
    return error;
}
