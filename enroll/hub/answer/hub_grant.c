#include "enroll/hub/answer/hub_grant.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "enroll/hub/store/hub_change.h"
#include "firmware/fleet/message/zone_key.h"

/* What take_zone() reads of a zone z. The place that a door has reported follows. */
#define ZONE                                                                       \
    "z.id, z.epoch, z.sequence, z.digest, z.base_sequence, z.base_digest, z.key, " \
    "z.reset_epoch, z.reset_sequence, z.behind, z.local_people, z.lease_s"

static int take_zone(struct hub_store *store, const PGresult *rows, int row,
                     struct hub__door_zone *out, struct iso_fault *fault)
{
    size_t size = 0;
    const uint8_t *sealed = hub_row_bytes(rows, row, 6, &size);
    *out = (struct hub__door_zone){.place.zone = hub_row_id(rows, row, 0),
                                   .place.epoch = (uint64_t)hub_row_integer(rows, row, 1),
                                   .place.sequence = (uint64_t)hub_row_integer(rows, row, 2),
                                   .base.sequence = (uint64_t)hub_row_integer(rows, row, 4),
                                   .reset_epoch = (uint64_t)hub_row_integer(rows, row, 7),
                                   .reset_sequence = (uint64_t)hub_row_integer(rows, row, 8),
                                   .behind = hub_row_switch(rows, row, 9),
                                   .local_people = hub_row_switch(rows, row, 10),
                                   .lease_s = (uint32_t)hub_row_integer(rows, row, 11),
                                   .known = !PQgetisnull(rows, row, 12),
                                   .reported.epoch = (uint64_t)hub_row_integer(rows, row, 12),
                                   .reported.sequence = (uint64_t)hub_row_integer(rows, row, 13)};
    out->base.zone = out->reported.zone = out->place.zone;
    out->base.epoch = out->place.epoch;
    if (hub_row_copy(rows, row, 3, out->place.digest, sizeof out->place.digest) ||
        hub_row_copy(rows, row, 5, out->base.digest, sizeof out->base.digest) ||
        (out->known &&
         hub_row_copy(rows, row, 14, out->reported.digest, sizeof out->reported.digest))) {
        return iso_fault_set(fault, -EBADMSG, "a zone: its digest is damaged");
    }
    return hub__zone_key_open(store, &out->place.zone, sealed, size, &out->key, fault);
}

int hub__door_zones(struct hub_store *store, const struct iso_fleet_id *door,
                    struct hub__door_zones *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, door);
    int error = hub_db_run_often(store->db,
                                 "SELECT " ZONE ", p.epoch, p.sequence, p.digest "
                                 "FROM door_zone dz JOIN zone z ON z.id = dz.zone "
                                 "LEFT JOIN door_place p ON p.door = dz.door AND p.zone = z.id "
                                 "WHERE dz.door = $1 ORDER BY dz.position",
                                 &values, &rows, fault);
    out->n = 0;
    for (int i = 0; !error && i < PQntuples(rows) && out->n < ISO_FLEET_ZONES_MAX; i++) {
        error = take_zone(store, rows, i, &out->zones[out->n++], fault);
    }
    PQclear(rows);
    return error;
}

int hub__key_zone(struct hub_store *store, const struct iso_fleet_id *zone,
                  struct hub__door_zone *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, zone);
    int error = hub_db_run(store->db,
                           "SELECT " ZONE ", NULL::bigint, NULL::bigint, NULL::bytea "
                           "FROM zone z WHERE z.id = $1",
                           &values, &rows, fault);
    if (!error) {
        error = PQntuples(rows) > 0 ? take_zone(store, rows, 0, out, fault)
                                    : iso_fault_set(fault, -ENOENT, "there is no such zone");
        PQclear(rows);
    }
    return error;
}

void hub__door_zones_wipe(struct hub__door_zones *zones)
{
    sodium_memzero(zones, sizeof *zones);
}

bool hub__wants_key(const struct hub__door_zone *zone)
{
    return !zone->known || zone->reported.epoch < zone->place.epoch;
}

int hub__emit_key(struct hub_store *store, const struct hub_door *door,
                  const struct hub__door_zone *zone, const struct hub_emit *emit,
                  struct iso_fault *fault)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    char topic[ISO_FLEET_TOPIC_SIZE];
    /* A door that has missed the epoch of a reset has another history, also in later epochs. */
    struct iso_fleet_key_grant grant = {.door = door->id,
                                        .base = zone->base,
                                        .reset = zone->known &&
                                                 zone->reported.epoch < zone->reset_epoch,
                                        .key = zone->key};
    int error = iso_fleet_make_key(&grant, door->receives, &store->keys.signs, &bytes);
    sodium_memzero(&grant, sizeof grant);
    if (error) {
        return iso_fault_set(fault, error, "door %s: a key: no memory", door->name);
    }
    error = emit->emit(emit->context, iso_fleet_topic_in(&door->id, topic), bytes.bytes, bytes.size,
                       false);
    iso_fleet_bytes_free(&bytes);
    return error ? iso_fault_set(fault, error, "door %s: a key could not be sent", door->name) : 0;
}
