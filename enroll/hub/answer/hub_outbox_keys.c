#include "enroll/hub/answer/hub_outbox_keys.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>

#include "enroll/hub/answer/hub_grant.h"

/* The entry of the zone, which is made if it is missing, and begins anew with another epoch. NULL:
 * no memory. */
static struct hub_outbox_keys *entry_of(struct hub_outbox *outbox,
                                        const struct iso_fleet_place *place)
{
    struct hub_outbox_keys *entry = NULL;
    for (size_t i = 0; !entry && i < outbox->n_keys; i++) {
        entry = iso_fleet_id_is_same(&outbox->keys[i].zone, &place->zone) ? &outbox->keys[i] : NULL;
    }
    if (!entry) {
        struct hub_outbox_keys *more = reallocarray(outbox->keys, outbox->n_keys + 1,
                                                    sizeof *outbox->keys);
        if (!more) {
            return NULL;
        }
        outbox->keys = more;
        entry = &more[outbox->n_keys++];
        *entry = (struct hub_outbox_keys){.epoch = 0};
    }
    if (entry->epoch != place->epoch) {
        *entry = (struct hub_outbox_keys){.zone = place->zone, .epoch = place->epoch};
    }
    return entry;
}

/* The next doors that lack the key. */
static int next_doors(struct hub_store *store, const struct hub_outbox_keys *entry, PGresult **rows,
                      struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &entry->zone);
    hub_value_integer(&values, (int64_t)entry->epoch);
    hub_value_id(&values, &entry->last);
    hub_value_integer(&values, HUB_OUTBOX_KEYS);
    return hub_db_run(store->db,
                      "SELECT d.id, d.name, d.receives, p.epoch FROM door_zone dz "
                      "JOIN door d ON d.id = dz.door "
                      "LEFT JOIN door_place p ON p.door = d.id AND p.zone = dz.zone "
                      "WHERE dz.zone = $1 AND d.joined_s > 0 AND d.expelled_s = 0 "
                      "AND (p.epoch IS NULL OR p.epoch < $2) AND d.id > $3 "
                      "ORDER BY d.id LIMIT $4",
                      &values, rows, fault);
}

/* The key for the door of one row. */
static int emit_key(struct hub_store *store, const PGresult *rows, int row,
                    struct hub__door_zone *zone, const struct hub_emit *emit,
                    struct iso_fault *fault)
{
    struct hub_door door = {.id = hub_row_id(rows, row, 0)};
    (void)snprintf(door.name, sizeof door.name, "%s", hub_row_text(rows, row, 1));
    zone->known = !PQgetisnull(rows, row, 3);
    zone->reported.epoch = (uint64_t)hub_row_integer(rows, row, 3);
    return hub_row_copy(rows, row, 2, door.receives, sizeof door.receives)
               ? iso_fault_set(fault, -EBADMSG, "door %s: its key is damaged", door.name)
               : hub__emit_key(store, &door, zone, emit, fault);
}

static void forget_entry(struct hub_outbox *outbox, struct hub_outbox_keys *entry)
{
    *entry = outbox->keys[--outbox->n_keys];
}

int hub__outbox_keys(struct hub_store *store, const struct iso_fleet_place *place,
                     const struct hub_emit *emit, struct hub_outbox *outbox, bool *done,
                     struct iso_fault *fault)
{
    struct hub__door_zone zone = {.known = false};
    PGresult *rows = NULL;
    struct hub_outbox_keys *entry = entry_of(outbox, place);
    int error = entry ? next_doors(store, entry, &rows, fault)
                      : iso_fault_set(fault, -ENOMEM, "the keys of a zone: no memory");
    error = error ? error : hub__key_zone(store, &place->zone, &zone, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        error = emit_key(store, rows, i, &zone, emit, fault);
        entry->last = error ? entry->last : hub_row_id(rows, i, 0);
    }
    *done = !error && PQntuples(rows) < HUB_OUTBOX_KEYS;
    if (*done) {
        forget_entry(outbox, entry);
    }
    PQclear(rows);
    sodium_memzero(&zone, sizeof zone);
    return error;
}
