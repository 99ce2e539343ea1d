#include "enroll/hub/answer/hub_outbox.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/answer/hub_outbox_keys.h"
#include "enroll/hub/store/hub_change.h"
#include "enroll/hub/store/hub_zone.h"
#include "firmware/fleet/message/head.h"

enum { DELTAS_AT_ONCE = 50 };

/* A zone of which the broker does not have everything. */
struct pending {
    struct iso_fleet_place place;
    uint64_t published, published_epoch, snapshot_sequence;
};

static int emit_failed(int error, const char *what, struct iso_fault *fault)
{
    return iso_fault_set(fault, error, "the broker: %s could not be sent", what);
}

static int emit_head(struct hub_store *store, const struct iso_fleet_place *place,
                     uint64_t snapshot_sequence, const struct hub_emit *emit,
                     struct iso_fault *fault)
{
    const struct iso_fleet_head head = {
        .place = *place, .time_s = store->now_s(), .snapshot_sequence = snapshot_sequence};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    char topic[ISO_FLEET_TOPIC_SIZE];
    int error = iso_fleet_make_head(&head, &store->keys.signs, &bytes);
    if (error) {
        return iso_fault_set(fault, error, "a head: no memory");
    }
    error = emit->emit(emit->context, iso_fleet_topic_head(&place->zone, topic), bytes.bytes,
                       bytes.size, true);
    iso_fleet_bytes_free(&bytes);
    return error ? emit_failed(error, "a head", fault) : 0;
}

/* Emits some deltas behind zone->published, up to the place that was read. */
static int emit_deltas(struct hub_store *store, struct pending *zone, uint32_t *most,
                       const struct hub_emit *emit, struct iso_fault *fault)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &zone->place.zone);
    hub_value_integer(&values, (int64_t)zone->published);
    hub_value_integer(&values, (int64_t)zone->place.sequence);
    hub_value_integer(&values, *most < DELTAS_AT_ONCE ? *most : DELTAS_AT_ONCE);
    int error = hub_db_run(store->db,
                           "SELECT sequence, bytes FROM delta WHERE zone = $1 AND sequence > $2 "
                           "AND sequence <= $3 ORDER BY sequence LIMIT $4",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) == 0) {
        zone->published = zone->place.sequence; /* the others are gone */
    }
    (void)iso_fleet_topic_delta(&zone->place.zone, topic);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        size_t size = 0;
        const uint8_t *bytes = hub_row_bytes(rows, i, 1, &size);
        error = emit->emit(emit->context, topic, bytes, size, false);
        error = error ? emit_failed(error, "a delta", fault) : 0;
        if (!error) {
            zone->published = (uint64_t)hub_row_integer(rows, i, 0);
            (*most)--;
        }
    }
    PQclear(rows);
    return error;
}

/* A door cannot open a delta of a new epoch without its key, so the deltas wait for the keys. */
static int publish(struct hub_store *store, struct pending *zone, uint32_t most,
                   const struct hub_emit *emit, struct hub_outbox *outbox, struct iso_fault *fault)
{
    bool has_keys = zone->published_epoch >= zone->place.epoch;
    int error = has_keys ? 0
                         : hub__outbox_keys(store, &zone->place, emit, outbox, &has_keys, fault);
    if (error || !has_keys) {
        return error;
    }
    while (!error && most > 0 && zone->published < zone->place.sequence) {
        error = emit_deltas(store, zone, &most, emit, fault);
    }
    outbox->more = outbox->more || zone->published < zone->place.sequence;
    /* HEAD is published after the deltas, so that a door which reads HEAD finds all of them. */
    if (!error && zone->published >= zone->place.sequence) {
        error = emit_head(store, &zone->place, zone->snapshot_sequence, emit, fault);
        zone->published_epoch = error ? zone->published_epoch : zone->place.epoch;
    }
    return error;
}

#define PENDING                                                                          \
    "SELECT id, epoch, sequence, digest, published, published_epoch, "                   \
    "(SELECT coalesce(max(s.sequence), 0) FROM snapshot s WHERE s.zone = z.id)::bigint " \
    "FROM zone z "

static int take_pending(const PGresult *rows, int row, struct pending *out, struct iso_fault *fault)
{
    *out = (struct pending){.place.zone = hub_row_id(rows, row, 0),
                            .place.epoch = (uint64_t)hub_row_integer(rows, row, 1),
                            .place.sequence = (uint64_t)hub_row_integer(rows, row, 2),
                            .published = (uint64_t)hub_row_integer(rows, row, 4),
                            .published_epoch = (uint64_t)hub_row_integer(rows, row, 5),
                            .snapshot_sequence = (uint64_t)hub_row_integer(rows, row, 6)};
    return hub_row_copy(rows, row, 3, out->place.digest, sizeof out->place.digest)
               ? iso_fault_set(fault, -EBADMSG, "a zone: its digest is damaged")
               : 0;
}

static void forget_zones(struct hub_outbox *outbox)
{
    free(outbox->zones);
    outbox->zones = NULL;
    outbox->n = 0;
    outbox->more = false;
}

int hub_outbox_emit(struct hub_store *store, uint32_t most, const struct hub_emit *emit,
                    struct hub_outbox *outbox, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    forget_zones(outbox);
    int error = hub_db_run(store->db,
                           PENDING "WHERE published < sequence OR published_epoch < epoch "
                                   "ORDER BY id",
                           NULL, &rows, fault);
    if (!error && PQntuples(rows) > 0) {
        outbox->zones = calloc((size_t)PQntuples(rows), sizeof *outbox->zones);
        error = outbox->zones ? 0 : iso_fault_set(fault, -ENOMEM, "the zones: no memory");
    }
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct pending zone;
        error = take_pending(rows, i, &zone, fault);
        error = error ? error : publish(store, &zone, most, emit, outbox, fault);
        outbox->zones[outbox->n++] = (struct hub_outbox_zone){
            .zone = zone.place.zone,
            .published = zone.published,
            .published_epoch = zone.published_epoch};
    }
    PQclear(rows);
    return error;
}

int hub_outbox_confirm(struct hub_store *store, struct hub_outbox *outbox, struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < outbox->n; i++) {
        struct hub_values values = {.n = 0};
        hub_value_id(&values, &outbox->zones[i].zone);
        hub_value_integer(&values, (int64_t)outbox->zones[i].published);
        hub_value_integer(&values, (int64_t)outbox->zones[i].published_epoch);
        /* A recovery may have moved the cursor further in between. */
        error = hub_db_run(store->db,
                           "UPDATE zone SET published = greatest(published, $2), "
                           "published_epoch = greatest(published_epoch, $3) WHERE id = $1",
                           &values, NULL, fault);
    }
    forget_zones(outbox);
    return error;
}

void hub_outbox_free(struct hub_outbox *outbox)
{
    forget_zones(outbox);
    free(outbox->keys);
    *outbox = (struct hub_outbox){.n = 0};
}

int hub_outbox_heads(struct hub_store *store, const struct hub_emit *emit, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(store->db, PENDING "ORDER BY id", NULL, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct pending zone;
        error = take_pending(rows, i, &zone, fault);
        error = error ? error : emit_head(store, &zone.place, zone.snapshot_sequence, emit, fault);
    }
    PQclear(rows);
    return error;
}

int hub_leader_try(struct hub_store *store, bool *is_leader, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    /* The question also finds out whether the connection, and with it the lock, is still there. */
    int error = hub_db_run(store->db, "SELECT true", NULL, NULL, fault);
    if (error) {
        store->leader_generation = 0;
        return error;
    }
    if (store->leader_generation == hub_db_generation(store->db)) {
        *is_leader = true;
        return 0;
    }
    store->leader_generation = 0;
    error = hub_db_run(store->db, "SELECT pg_try_advisory_lock(" HUB_LEADER_LOCK ")", NULL, &rows,
                       fault);
    if (error) {
        return error;
    }
    *is_leader = hub_row_switch(rows, 0, 0);
    PQclear(rows);
    if (*is_leader) {
        store->leader_generation = hub_db_generation(store->db);
    }
    return 0;
}

int hub_leader_leave(struct hub_store *store, struct iso_fault *fault)
{
    if (store->leader_generation == 0) {
        return 0;
    }
    store->leader_generation = 0;
    return hub_db_run(store->db, "SELECT pg_advisory_unlock(" HUB_LEADER_LOCK ")", NULL, NULL,
                      fault);
}

int hub_listen(struct hub_store *store, int *fd, struct iso_fault *fault)
{
    const int error = hub_db_script(store->db, "LISTEN " HUB__NOTIFICATION, fault);
    if (!error) {
        *fd = PQsocket(hub_db_connection(store->db));
    }
    return error;
}

int hub_listen_take(struct hub_store *store, bool *changed, struct iso_fault *fault)
{
    PGconn *connection = hub_db_connection(store->db);
    bool found = false;
    if (!PQconsumeInput(connection)) {
        return iso_fault_set(fault, -ENOTCONN, "the database: the connection was lost");
    }
    for (PGnotify *one = PQnotifies(connection); one; one = PQnotifies(connection)) {
        found = true;
        PQfreemem(one);
    }
    *changed = found;
    return 0;
}
