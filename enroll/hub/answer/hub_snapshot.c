#include "enroll/hub/answer/hub_snapshot.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/people/hub_person_rows.h"
#include "enroll/hub/store/hub_change.h"
#include "enroll/hub/store/hub_zone.h"
#include "firmware/fleet/message/snapshot.h"

enum { CHUNK_BYTES = 1 << 20, PEOPLE_AT_ONCE = 100 };

/* A snapshot on its way into the table of chunks. */
struct making {
    struct hub_store *store;
    struct iso_fleet_id zone;
    int64_t id, chunks;
    struct iso_fleet_bytes chunk;
    struct iso_fault *fault;
    struct iso_fleet_snapshot_writer writer;
};

static int flush(struct making *m)
{
    struct hub_values values = {.n = 0};
    hub_value_integer(&values, m->id);
    hub_value_integer(&values, m->chunks);
    hub_value_bytes(&values, m->chunk.bytes, m->chunk.size);
    const int error = hub_db_run(m->store->db,
                                 "INSERT INTO snapshot_chunk (snapshot, number, bytes) "
                                 "VALUES ($1, $2, $3)",
                                 &values, NULL, m->fault);
    m->chunks++;
    m->chunk.size = 0;
    return error;
}

static int take_bytes(void *context, const void *bytes, size_t size)
{
    struct making *m = context;
    iso_fleet_put(&m->chunk, bytes, size);
    if (m->chunk.error) {
        return iso_fault_set(m->fault, -ENOMEM, "snapshot: no memory");
    }
    return m->chunk.size >= CHUNK_BYTES ? flush(m) : 0;
}

static int add_change(struct making *m, const struct iso_fleet_change *change)
{
    struct iso_fleet_bytes plain = {.bytes = NULL};
    iso_fleet_put_change(&plain, change);
    int error = plain.error ? plain.error
                            : iso_fleet_snapshot_add(&m->writer, plain.bytes, plain.size);
    iso_fleet_bytes_free(&plain);
    return error == -ENOMEM ? iso_fault_set(m->fault, error, "snapshot: no memory") : error;
}

/* Adds the next people behind *last. Their ids are limited before people and templates are joined,
 * so that each of the many statements of a large zone reads a few rows of the indexes alone; *more:
 * there may be others. */
static int add_people(struct making *m, struct iso_fleet_id *last, bool *more)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &m->zone);
    hub_value_id(&values, last);
    hub_value_integer(&values, PEOPLE_AT_ONCE);
    int error = hub_db_run(m->store->db,
                           "SELECT " HUB__PERSON_COLUMNS
                           "FROM (SELECT pz.person FROM person_zone pz WHERE pz.zone = $1 "
                           "AND pz.person > $2 ORDER BY pz.person LIMIT $3) next "
                           "JOIN person p ON p.id = next.person "
                           "LEFT JOIN template t ON t.person = p.id ORDER BY p.id, t.number",
                           &values, &rows, m->fault);
    *more = !error && PQntuples(rows) > 0;
    for (int row = 0; !error && row < PQntuples(rows);) {
        struct hub__person person;
        error = hub__person_take(m->store, rows, &row, &person, m->fault);
        if (!error) {
            const struct iso_fleet_change change = {.kind = ISO_FLEET_PUT, .person = person.person};
            error = add_change(m, &change);
            *last = person.person.id;
            hub__person_free(&person);
        }
    }
    PQclear(rows);
    return error;
}

/* Adds everything that holds in the zone: policy, lockdown, and then the people. */
static int add_all(struct making *m, bool lockdown)
{
    char *policy = NULL;
    int error = hub_zone_get_policy(m->store, &m->zone, &policy, m->fault);
    if (error) {
        return error;
    }
    const struct iso_fleet_change changes[2] = {
        {.kind = ISO_FLEET_POLICY, .policy = policy, .policy_length = strlen(policy)},
        {.kind = ISO_FLEET_LOCKDOWN, .lockdown = lockdown}};
    error = add_change(m, &changes[0]);
    error = error ? error : add_change(m, &changes[1]);
    free(policy);
    struct iso_fleet_id last = {.bytes = {0}};
    for (bool more = true; !error && more;) {
        error = add_people(m, &last, &more);
    }
    return error;
}

/* The row of the new snapshot, in place of older ones. */
static int begin_row(struct making *m, const struct iso_fleet_place *place)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &m->zone);
    hub_value_integer(&values, (int64_t)place->epoch);
    hub_value_integer(&values, (int64_t)place->sequence);
    hub_value_integer(&values, m->store->now_s());
    const int error = hub_db_run(m->store->db,
                                 "WITH old AS (DELETE FROM snapshot WHERE zone = $1) "
                                 "INSERT INTO snapshot (zone, epoch, sequence, made_s) "
                                 "VALUES ($1, $2, $3, $4) RETURNING id",
                                 &values, &rows, m->fault);
    if (!error) {
        m->id = hub_row_integer(rows, 0, 0);
        PQclear(rows);
    }
    return error;
}

static int write_all(struct making *m, const struct iso_fleet_place *place,
                     const struct iso_fleet_zone_key *key, bool lockdown)
{
    int error = begin_row(m, place);
    error = error ? error : iso_fleet_snapshot_begin(&m->writer, place, m->store->now_s(), key);
    error = error ? error : add_all(m, lockdown);
    error = error ? error : iso_fleet_snapshot_end(&m->writer, &m->store->keys.signs);
    return error ? error : flush(m);
}

/* Runs in REPEATABLE READ: place and people are of one moment, without a lock that would let the
 * changes of the zone wait. */
static int make(void *context, struct iso_fault *fault)
{
    struct making *m = context;
    struct hub_zone zone;
    struct hub_values values = {.n = 0};
    struct iso_fleet_zone_key key;
    PGresult *rows = NULL;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    size_t size = 0;
    m->fault = fault;
    m->chunks = 0;
    m->chunk.size = 0;
    hub_value_id(&values, &m->zone);
    int error = hub_zone_find(m->store, iso_fleet_id_text(&m->zone, text), &zone, fault);
    error = error ? error
                  : hub_db_run(m->store->db, "SELECT key FROM zone WHERE id = $1", &values, &rows,
                               fault);
    if (error) {
        return error;
    }
    m->writer = (struct iso_fleet_snapshot_writer){.write = take_bytes, .context = m};
    const uint8_t *sealed = hub_row_bytes(rows, 0, 0, &size);
    error = hub__zone_key_open(m->store, &m->zone, sealed, size, &key, fault);
    PQclear(rows);
    error = error ? error : write_all(m, &zone.place, &key, zone.lockdown);
    sodium_memzero(&key, sizeof key);
    sodium_memzero(&m->writer, sizeof m->writer);
    return error;
}

int hub_snapshot_make(struct hub_store *store, const struct iso_fleet_id *zone,
                      struct iso_fault *fault)
{
    struct making m = {.store = store, .zone = *zone};
    const int error = hub_db_transaction(store->db, HUB_REPEATABLE_READ, make, &m, fault);
    iso_fleet_bytes_free(&m.chunk);
    return error;
}

int hub__snapshot_ensure(struct hub_store *store, const struct iso_fleet_id *zone,
                         struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, zone);
    hub_value_integer(&values, HUB_SNAPSHOT_AGE_MAX);
    const int error = hub_db_run(store->db,
                                 "SELECT EXISTS (SELECT 1 FROM snapshot s JOIN zone z "
                                 "ON z.id = s.zone WHERE z.id = $1 AND s.epoch = z.epoch AND "
                                 "z.sequence - s.sequence <= $2 AND (SELECT count(*) FROM delta d "
                                 "WHERE d.zone = z.id AND d.sequence > s.sequence) = "
                                 "z.sequence - s.sequence)",
                                 &values, &rows, fault);
    if (error) {
        return error;
    }
    const bool exists = hub_row_switch(rows, 0, 0);
    PQclear(rows);
    return exists ? 0 : hub_snapshot_make(store, zone, fault);
}

/* Reads chunk after chunk, so that a long snapshot is never in memory as a whole. */
struct reading {
    struct hub_store *store;
    struct iso_fleet_id zone;
    int (*write)(void *context, const void *bytes, size_t size);
    void *context;
    bool has_begun;
};

static int write_chunks(struct reading *r, int64_t id, struct iso_fault *fault)
{
    int error = 0;
    for (int64_t number = 0; !error; number++) {
        struct hub_values values = {.n = 0};
        PGresult *rows = NULL;
        size_t size = 0;
        hub_value_integer(&values, id);
        hub_value_integer(&values, number);
        error = hub_db_run(r->store->db,
                           "SELECT bytes FROM snapshot_chunk WHERE snapshot = $1 AND number = $2",
                           &values, &rows, fault);
        if (error) {
            break;
        }
        if (PQntuples(rows) == 0) {
            PQclear(rows);
            break;
        }
        const uint8_t *bytes = hub_row_bytes(rows, 0, 0, &size);
        r->has_begun = true;
        if (r->write(r->context, bytes, size)) {
            error = iso_fault_set(fault, -EPIPE, "a snapshot could not be sent");
        }
        PQclear(rows);
    }
    return error;
}

static int read_snapshot(void *context, struct iso_fault *fault)
{
    struct reading *r = context;
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    /* The beginning is out already: a second attempt would send it again. */
    if (r->has_begun) {
        return iso_fault_set(fault, -EIO, "a snapshot could not be read to its end");
    }
    hub_value_id(&values, &r->zone);
    int error = hub_db_run(r->store->db,
                           "SELECT s.id FROM snapshot s JOIN zone z ON z.id = s.zone "
                           "AND z.epoch = s.epoch WHERE s.zone = $1 ORDER BY s.sequence DESC, "
                           "s.id DESC LIMIT 1",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    error = PQntuples(rows) == 0 ? iso_fault_set(fault, -ENODATA, "there is no snapshot")
                                 : write_chunks(r, hub_row_integer(rows, 0, 0), fault);
    PQclear(rows);
    return error;
}

int hub__snapshot_write(struct hub_store *store, const struct iso_fleet_id *zone,
                        int (*write)(void *context, const void *bytes, size_t size), void *context,
                        struct iso_fault *fault)
{
    struct reading r = {.store = store, .zone = *zone, .write = write, .context = context};
    return hub_db_transaction(store->db, HUB_REPEATABLE_READ, read_snapshot, &r, fault);
}
