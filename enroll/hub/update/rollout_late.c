/* Doors that keep a stage from its end: the expelled ones, and those that are late. */
#include "enroll/hub/update/rollout_rows.h"

int hub__rollout_leave_out_expelled(struct hub_store *store, const struct iso_fleet_id *rollout,
                                    struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, rollout);
    hub_value_integer(&values, store->now_s());
    return hub_db_run_often(store->db,
                            "UPDATE rollout_door d SET state = 'unable', counts = false, "
                            "changed_s = $2, fault = 'it is expelled' FROM door "
                            "WHERE door.id = d.door AND d.rollout = $1 AND door.expelled_s > 0 "
                            "AND d.state NOT IN ('unable', 'healthy')",
                            &values, NULL, fault);
}

int hub__rollout_fail_late(struct hub_store *store, const struct iso_fleet_id *rollout,
                           int64_t watched_s, int64_t clock_s, struct iso_fault *fault)
{
    const int64_t now_s = store->now_s();
    struct hub_values values = {.n = 0};
    hub_value_id(&values, rollout);
    hub_value_integer(&values, now_s);
    hub_value_integer(&values, watched_s);
    hub_value_integer(&values, now_s - HUB_UPDATE_SILENT_S);
    hub_value_integer(&values, clock_s);
    hub_value_integer(&values, HUB_UPDATE_STILL_S);
    /* A door that was silent is told again when it comes back, and the time that it has been at
     * work goes on: it may come and go. One that was at work for too long would begin the same
     * again, so it stays failed. */
    return hub_db_run_often(
        store->db,
        "WITH late AS (SELECT d.door, greatest(door.reported_s, d.changed_s, $3) < $4 AS silent, "
        "d.mute_s > 0 AND greatest(d.mute_s, $3) < $4 AS mute, "
        "d.work_s + $5 - d.work_from_s > $6 AS still "
        "FROM rollout_door d JOIN door ON door.id = d.door WHERE d.rollout = $1 AND d.counts "
        "AND d.state IN ('told', 'fetching', 'installed')) "
        "UPDATE rollout_door d SET state = 'failed', changed_s = $2, "
        "work_s = d.work_s + $5 - d.work_from_s, "
        "finished_s = CASE WHEN d.finished_s > 0 THEN d.finished_s ELSE $2 END, "
        "stuck = NOT (late.silent OR late.mute), "
        "fault = CASE WHEN late.silent THEN 'it does not report' "
        "WHEN late.mute THEN 'it reports, but says nothing of its updates' "
        "ELSE 'it was ' || d.state || ' for too long' || "
        "CASE WHEN d.fault = '' THEN '' ELSE ': ' || left(d.fault, 130) END END "
        "FROM late WHERE d.rollout = $1 AND d.door = late.door "
        "AND (late.silent OR late.mute OR late.still)",
        &values, NULL, fault);
}
