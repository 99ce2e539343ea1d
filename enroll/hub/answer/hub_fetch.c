/* FETCH of a door: deltas or a snapshot. */
#include <errno.h>
#include <string.h>

#include "core/base/bytes.h"
#include "enroll/hub/answer/hub_grant.h"
#include "enroll/hub/answer/hub_sender.h"
#include "enroll/hub/answer/hub_snapshot.h"

enum { DELTAS_AT_ONCE = 200 };

struct fetching {
    struct hub_store *store;
    struct iso_fleet_fetch fetch;
    int (*write)(void *context, const void *bytes, size_t size);
    void *context;
    size_t written;
};

/* Finds the zone among those of the door. */
static int find_zone(const struct fetching *f, const struct hub_door *door,
                     struct hub__door_zone *out, struct iso_fault *fault)
{
    struct hub__door_zones zones;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    int error = hub__door_zones(f->store, &door->id, &zones, fault);
    if (error) {
        return error;
    }
    error = -EACCES;
    for (size_t i = 0; i < zones.n; i++) {
        if (iso_fleet_id_is_same(&zones.zones[i].place.zone, &f->fetch.zone)) {
            *out = zones.zones[i];
            error = 0;
        }
    }
    hub__door_zones_wipe(&zones);
    return error ? iso_fault_set(fault, error, "door %s: asks for zone %s, which is not its own",
                                 door->name, iso_fleet_id_text(&f->fetch.zone, text))
                 : 0;
}

/* Whether all deltas behind a sequence are there, without a reset in between. */
static int has_all(const struct fetching *f, const struct hub__door_zone *zone, bool *out,
                   struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    if (f->fetch.after >= zone->place.sequence) {
        *out = true;
        return 0;
    }
    if (f->fetch.after < zone->reset_sequence) {
        *out = false;
        return 0;
    }
    hub_value_id(&values, &f->fetch.zone);
    hub_value_integer(&values, (int64_t)f->fetch.after);
    const int error = hub_db_run(f->store->db,
                                 "SELECT min(sequence) FROM delta WHERE zone = $1 "
                                 "AND sequence > $2",
                                 &values, &rows, fault);
    if (!error) {
        *out = (uint64_t)hub_row_integer(rows, 0, 0) == f->fetch.after + 1;
        PQclear(rows);
    }
    return error;
}

static int write_delta(struct fetching *f, const uint8_t *bytes, size_t size,
                       struct iso_fault *fault)
{
    uint8_t length[4];
    (void)iso_put_u32(length, (uint32_t)size);
    if (f->write(f->context, length, sizeof length) || f->write(f->context, bytes, size)) {
        return iso_fault_set(fault, -EPIPE, "deltas could not be sent");
    }
    f->written += sizeof length + size;
    return 0;
}

/* Writes the next deltas behind *after; *more: there may be others, and there is room for them. */
static int write_some(struct fetching *f, uint64_t *after, bool *more, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &f->fetch.zone);
    hub_value_integer(&values, (int64_t)*after);
    hub_value_integer(&values, DELTAS_AT_ONCE);
    /* The sum keeps what is read at once within the bound; the first delta always comes. */
    hub_value_integer(&values, (int64_t)(HUB_FETCH_BYTES_MAX - f->written));
    int error = hub_db_run(f->store->db,
                           "SELECT sequence, bytes FROM (SELECT sequence, bytes, "
                           "sum(length(bytes) + 4) OVER (ORDER BY sequence) AS total FROM "
                           "(SELECT * FROM delta WHERE zone = $1 AND sequence > $2 "
                           "ORDER BY sequence LIMIT $3) d) t WHERE total <= $4 ORDER BY sequence",
                           &values, &rows, fault);
    *more = !error && PQntuples(rows) > 0;
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        size_t size = 0;
        const uint8_t *bytes = hub_row_bytes(rows, i, 1, &size);
        *after = (uint64_t)hub_row_integer(rows, i, 0);
        error = write_delta(f, bytes, size, fault);
    }
    PQclear(rows);
    return error;
}

static int write_deltas(struct fetching *f, struct iso_fault *fault)
{
    uint64_t after = f->fetch.after;
    int error = 0;
    for (bool more = true; !error && more;) {
        error = write_some(f, &after, &more, fault);
    }
    return error;
}

static int write_snapshot(struct fetching *f, struct iso_fault *fault)
{
    int error = hub__snapshot_ensure(f->store, &f->fetch.zone, fault);
    error = error ? error
                  : hub__snapshot_write(f->store, &f->fetch.zone, f->write, f->context, fault);
    /* An epoch has begun in between. */
    if (error == -ENODATA) {
        error = hub_snapshot_make(f->store, &f->fetch.zone, fault);
        error = error ? error
                      : hub__snapshot_write(f->store, &f->fetch.zone, f->write, f->context, fault);
    }
    return error;
}

int hub_answer_fetch(struct hub_store *store, const void *bytes, size_t size,
                     int (*write)(void *context, const void *bytes, size_t size), void *context,
                     enum hub_fetch_answer *what, struct iso_fault *fault)
{
    struct fetching f = {.store = store, .write = write, .context = context};
    struct hub_door door;
    struct hub__door_zone zone = {.known = false};
    bool all = false;
    int error = hub__sender(store, bytes, size, &door, fault);
    if (error) {
        return error;
    }
    error = iso_fleet_read_fetch(bytes, size, door.signs, &f.fetch);
    if (error || f.fetch.after > INT64_MAX / 2) {
        return hub__sender_fault(&door, "fetch", error ? error : -EBADMSG, fault);
    }
    error = find_zone(&f, &door, &zone, fault);
    if (!error && f.fetch.what == ISO_FLEET_WANT_DELTAS) {
        error = has_all(&f, &zone, &all, fault);
    }
    if (error) {
        return error;
    }
    *what = all ? HUB_ANSWER_DELTAS : HUB_ANSWER_SNAPSHOT;
    return all ? write_deltas(&f, fault) : write_snapshot(&f, fault);
}
