/* New epochs of zones that a person asks for. */
#include <errno.h>

#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/store/hub_change.h"
#include "enroll/hub/store/hub_zone.h"

/* How far the revisions of people rise at a recovery: above all that the lost database has given.
 */
#define REVISION_STEP "4294967296"

struct work {
    struct hub_store *store;
    struct iso_fleet_id id;
};

static json_t *place_json(const struct iso_fleet_place *place)
{
    return json_pack("{s:I,s:I}", "epoch", (json_int_t)place->epoch, "sequence",
                     (json_int_t)place->sequence);
}

static int new_epoch(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub__zone zone;
    int error = hub__zone_lock(w->store, &w->id, &zone, fault);
    json_t *before = error ? NULL : place_json(&zone.place);
    error = error ? error : hub__zone_next_epoch(w->store, &zone, fault);
    if (error) {
        json_decref(before);
    } else {
        error = hub__act_add(w->store, "zone-epoch", zone.name, before, place_json(&zone.place),
                             fault);
    }
    hub__zone_wipe(&zone);
    return error;
}

int hub_zone_new_epoch(struct hub_store *store, const struct iso_fleet_id *zone,
                       struct iso_fault *fault)
{
    struct work w = {.store = store, .id = *zone};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, new_epoch, &w, fault);
}

/* The highest epoch and sequence that a door has reported. */
static int highest_report(struct hub_store *store, const struct iso_fleet_id *id, uint64_t *epoch,
                          uint64_t *sequence, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, id);
    const int error = hub_db_run(store->db,
                                 "SELECT coalesce(max(epoch), 0)::bigint, "
                                 "coalesce(max(sequence), 0)::bigint FROM door_place "
                                 "WHERE zone = $1",
                                 &values, &rows, fault);
    if (!error) {
        *epoch = (uint64_t)hub_row_integer(rows, 0, 0);
        *sequence = (uint64_t)hub_row_integer(rows, 0, 1);
        PQclear(rows);
    }
    return error;
}

/* A door drops a PUT whose revision is not above the one that it has. The revisions of the lost
 * database are not known, so all people of the zone get much higher ones. */
static int raise_revisions(struct hub_store *store, const struct iso_fleet_id *id,
                           struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    int error = hub_db_run(store->db,
                           "SELECT setval('person_revision', nextval('person_revision') "
                           "+ " REVISION_STEP ")",
                           NULL, NULL, fault);
    hub_value_id(&values, id);
    return error ? error
                 : hub_db_run(store->db,
                              "UPDATE person SET revision = nextval('person_revision') WHERE id IN "
                              "(SELECT person FROM person_zone WHERE zone = $1)",
                              &values, NULL, fault);
}

static int reset(struct hub_store *store, struct hub__zone *zone, struct iso_fault *fault)
{
    uint64_t epoch = 0, sequence = 0;
    json_t *before = place_json(&zone->place);
    int error = highest_report(store, &zone->place.zone, &epoch, &sequence, fault);
    epoch = epoch > zone->place.epoch ? epoch : zone->place.epoch;
    sequence = sequence > zone->place.sequence ? sequence : zone->place.sequence;
    error = error ? error : raise_revisions(store, &zone->place.zone, fault);
    error = error ? error : hub__zone_reset(store, zone, epoch + 1, sequence + 1, fault);
    if (error) {
        json_decref(before);
        return error;
    }
    return hub__act_add(store, "zone-recover", zone->name, before, place_json(&zone->place), fault);
}

static int recover(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub__zone zone;
    int error = hub__zone_lock_any(w->store, &w->id, &zone, fault);
    if (!error && !zone.behind) {
        error = iso_fault_set(fault, -EALREADY, "zone %s: no door knows more than this database",
                              zone.name);
    }
    error = error ? error : reset(w->store, &zone, fault);
    hub__zone_wipe(&zone);
    return error;
}

int hub_zone_recover(struct hub_store *store, const struct iso_fleet_id *zone,
                     struct iso_fault *fault)
{
    struct work w = {.store = store, .id = *zone};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, recover, &w, fault);
}
