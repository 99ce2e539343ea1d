#include "enroll/hub/store/hub_change.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/fleet/message/delta.h"

static const char key_use[] = "zone-key";

int hub__zone_key_open(struct hub_store *store, const struct iso_fleet_id *zone, const void *sealed,
                       size_t size, struct iso_fleet_zone_key *out, struct iso_fault *fault)
{
    struct iso_fleet_bytes plain = {.bytes = NULL};
    const int error = hub_keys_open(&store->keys, key_use, zone, sealed, size, &plain);
    if (error == -ENOMEM) {
        return iso_fault_set(fault, error, "the key of a zone: no memory");
    }
    if (error || plain.size != sizeof out->bytes) {
        iso_fleet_bytes_free(&plain);
        return iso_fault_set(fault, -EBADMSG,
                             "the key of a zone cannot be opened: the key file belongs to another "
                             "database");
    }
    memcpy(out->bytes, plain.bytes, sizeof out->bytes);
    iso_fleet_bytes_free(&plain);
    return 0;
}

int hub__zone_key_make(struct hub_store *store, const struct iso_fleet_id *zone,
                       struct iso_fleet_zone_key *out, struct iso_fleet_bytes *sealed,
                       struct iso_fault *fault)
{
    randombytes_buf(out->bytes, sizeof out->bytes);
    const int error = hub_keys_seal(&store->keys, key_use, zone, out->bytes, sizeof out->bytes,
                                    sealed);
    return error ? iso_fault_set(fault, error, "the key of a zone: no memory") : 0;
}

static int take_zone(struct hub_store *store, const PGresult *rows, struct hub__zone *out,
                     struct iso_fault *fault)
{
    size_t size = 0;
    const uint8_t *sealed = hub_row_bytes(rows, 0, 4, &size);
    (void)snprintf(out->name, sizeof out->name, "%s", hub_row_text(rows, 0, 0));
    out->place.epoch = (uint64_t)hub_row_integer(rows, 0, 1);
    out->place.sequence = (uint64_t)hub_row_integer(rows, 0, 2);
    out->lockdown = hub_row_switch(rows, 0, 5);
    out->behind = hub_row_switch(rows, 0, 6);
    if (hub_row_copy(rows, 0, 3, out->place.digest, sizeof out->place.digest)) {
        return iso_fault_set(fault, -EBADMSG, "zone %s: its digest is damaged", out->name);
    }
    return hub__zone_key_open(store, &out->place.zone, sealed, size, &out->key, fault);
}

int hub__zone_lock_any(struct hub_store *store, const struct iso_fleet_id *id,
                       struct hub__zone *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    *out = (struct hub__zone){.place.zone = *id};
    hub_value_id(&values, id);
    int error = hub_db_run(store->db,
                           "SELECT name, epoch, sequence, digest, key, lockdown, behind FROM zone "
                           "WHERE id = $1 FOR NO KEY UPDATE",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    error = PQntuples(rows) == 0 ? iso_fault_set(fault, -ENOENT, "there is no such zone")
                                 : take_zone(store, rows, out, fault);
    PQclear(rows);
    return error;
}

int hub__zone_lock(struct hub_store *store, const struct iso_fleet_id *id, struct hub__zone *out,
                   struct iso_fault *fault)
{
    int error = hub__zone_lock_any(store, id, out, fault);
    if (!error && out->behind) {
        error = iso_fault_set(fault, -ESTALE,
                              "zone %s: its doors know more than this database, which was restored "
                              "from an old copy; run isotherm-hub recover",
                              out->name);
        hub__zone_wipe(out);
    }
    return error;
}

void hub__zone_wipe(struct hub__zone *zone)
{
    sodium_memzero(zone, sizeof *zone);
}

/* Stores a delta, moves the zone, and notifies the leader, in one statement. */
static int store_delta(struct hub_store *store, const struct iso_fleet_place *place,
                       const struct iso_fleet_bytes *bytes, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &place->zone);
    hub_value_integer(&values, (int64_t)place->sequence);
    hub_value_integer(&values, (int64_t)place->epoch);
    hub_value_bytes(&values, place->digest, sizeof place->digest);
    hub_value_bytes(&values, bytes->bytes, bytes->size);
    return hub_db_run(store->db,
                      "WITH d AS (INSERT INTO delta (zone, sequence, epoch, digest, bytes) "
                      "VALUES ($1, $2, $3, $4, $5)), "
                      "z AS (UPDATE zone SET sequence = $2, digest = $4 WHERE id = $1) "
                      "SELECT pg_notify('" HUB__NOTIFICATION "', '')",
                      &values, NULL, fault);
}

int hub__zone_append(struct hub_store *store, struct hub__zone *zone,
                     const struct iso_fleet_change *change, struct iso_fault *fault)
{
    struct iso_fleet_bytes plain = {.bytes = NULL}, bytes = {.bytes = NULL};
    struct iso_fleet_delta delta = {.place = zone->place, .time_s = store->now_s()};
    memcpy(delta.before, zone->place.digest, sizeof delta.before);
    delta.place.sequence++;
    iso_fleet_put_change(&plain, change);
    int error = plain.error ? plain.error
                            : iso_fleet_make_delta(&delta, plain.bytes, plain.size, &zone->key,
                                                   &store->keys.signs, &bytes);
    iso_fleet_bytes_free(&plain);
    if (error) {
        return iso_fault_set(fault, error, "zone %s: %s", zone->name,
                             error == -EFBIG ? "the change is too large" : "no memory");
    }
    error = store_delta(store, &delta.place, &bytes, fault);
    iso_fleet_bytes_free(&bytes);
    if (!error) {
        zone->place = delta.place;
    }
    return error;
}

int hub__zone_change(struct hub_store *store, const struct iso_fleet_id *id,
                     const struct iso_fleet_change *change, struct iso_fault *fault)
{
    struct hub__zone zone;
    int error = hub__zone_lock(store, id, &zone, fault);
    error = error ? error : hub__zone_append(store, &zone, change, fault);
    hub__zone_wipe(&zone);
    return error;
}

int hub__zone_next_epoch(struct hub_store *store, struct hub__zone *zone, struct iso_fault *fault)
{
    struct iso_fleet_bytes sealed = {.bytes = NULL};
    struct hub_values values = {.n = 0};
    int error = hub__zone_key_make(store, &zone->place.zone, &zone->key, &sealed, fault);
    if (error) {
        return error;
    }
    hub_value_id(&values, &zone->place.zone);
    hub_value_bytes(&values, sealed.bytes, sealed.size);
    error = hub_db_run(store->db,
                       "WITH z AS (UPDATE zone SET epoch = epoch + 1, key = $2, "
                       "base_sequence = sequence, base_digest = digest WHERE id = $1) "
                       "SELECT pg_notify('" HUB__NOTIFICATION "', '')",
                       &values, NULL, fault);
    iso_fleet_bytes_free(&sealed);
    if (!error) {
        zone->place.epoch++;
    }
    return error;
}

int hub__zone_renew(struct hub_store *store, const struct iso_fleet_id *id, struct iso_fault *fault)
{
    struct hub__zone zone;
    int error = hub__zone_lock_any(store, id, &zone, fault);
    error = error || zone.behind ? error : hub__zone_next_epoch(store, &zone, fault);
    hub__zone_wipe(&zone);
    return error;
}

int hub__zone_reset(struct hub_store *store, struct hub__zone *zone, uint64_t epoch,
                    uint64_t sequence, struct iso_fault *fault)
{
    struct iso_fleet_bytes sealed = {.bytes = NULL};
    struct hub_values values = {.n = 0};
    int error = hub__zone_key_make(store, &zone->place.zone, &zone->key, &sealed, fault);
    if (error) {
        return error;
    }
    /* A digest that no history has. */
    zone->place.epoch = epoch;
    zone->place.sequence = sequence;
    randombytes_buf(zone->place.digest, sizeof zone->place.digest);
    hub_value_id(&values, &zone->place.zone);
    hub_value_integer(&values, (int64_t)epoch);
    hub_value_integer(&values, (int64_t)sequence);
    hub_value_bytes(&values, zone->place.digest, sizeof zone->place.digest);
    hub_value_bytes(&values, sealed.bytes, sealed.size);
    error = hub_db_run(store->db,
                       "WITH z AS (UPDATE zone SET epoch = $2, sequence = $3, digest = $4, "
                       "key = $5, base_sequence = $3, base_digest = $4, reset_epoch = $2, "
                       "reset_sequence = $3, published = $3, behind = false WHERE id = $1), "
                       "s AS (DELETE FROM snapshot WHERE zone = $1) "
                       "SELECT pg_notify('" HUB__NOTIFICATION "', '')",
                       &values, NULL, fault);
    iso_fleet_bytes_free(&sealed);
    return error;
}

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct iso_fleet_id));
}

size_t hub__ids_in_order(struct iso_fleet_id *ids, size_t n)
{
    size_t kept = 0;
    if (n > 1) {
        qsort(ids, n, sizeof *ids, compare);
    }
    for (size_t i = 0; i < n; i++) {
        if (kept == 0 || !iso_fleet_id_is_same(&ids[kept - 1], &ids[i])) {
            ids[kept++] = ids[i];
        }
    }
    return kept;
}
