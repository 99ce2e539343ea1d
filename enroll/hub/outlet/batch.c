#include "enroll/hub/outlet/batch.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

/* Which records a list of names ($N) lets through. */
#define PASSES(n) "(" n " = '' OR e.record->>'event' = ANY (string_to_array(" n ", ','))) "

struct work {
    struct hub_store *store;
    const struct hub_outlet *outlet;
    struct iso_fleet_id id, key;
    struct hub__batch *out;
    const struct hub__batch *batch;
    size_t room; /* for how many events there is room */
};

void hub__batch_clear(struct hub__batch *batch)
{
    PQclear(batch->rows);
    *batch = (struct hub__batch){.n = 0};
}

struct hub__batch_event hub__batch_event(const struct hub__batch *batch, size_t i)
{
    const int row = (int)i;
    return batch->one ? *batch->one
                      : (struct hub__batch_event){
                            .door = hub_row_id(batch->rows, row, 0),
                            .door_name = hub_row_text(batch->rows, row, 1),
                            .number = (uint64_t)hub_row_integer(batch->rows, row, 2),
                            .time = hub_row_text(batch->rows, row, 3),
                            .event = hub_row_text(batch->rows, row, 4),
                            .record = hub_row_text(batch->rows, row, 5),
                        };
}

/* Where the batch of one door ends, and how many events it has. */
static int measure(struct work *w, const struct iso_fleet_id *door, int64_t after, int64_t acked,
                   int64_t *end, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, door);
    hub_value_integer(&values, after);
    hub_value_integer(&values, acked);
    hub_value_text(&values, w->outlet->events);
    hub_value_integer(&values, (int64_t)w->room);
    const int error = hub_db_run(
        w->store->db,
        "SELECT count(*), max(number) FROM (SELECT e.number FROM event e "
        "WHERE e.door = $1 AND e.number > $2 AND e.number <= $3 AND " PASSES(
            "$4") "ORDER BY e.number LIMIT $5) next",
        &values, &rows, fault);
    if (error) {
        return error;
    }
    const size_t n = (size_t)hub_row_integer(rows, 0, 0);
    /* Without a full batch nothing else of the door passes the filter. */
    *end = n == w->room ? hub_row_integer(rows, 0, 1) : acked;
    w->room -= n;
    PQclear(rows);
    return 0;
}

static int set_end(const struct work *w, const struct iso_fleet_id *door, int64_t after,
                   int64_t end, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->id);
    hub_value_id(&values, door);
    hub_value_integer(&values, after);
    hub_value_integer(&values, end);
    return hub_db_run(w->store->db,
                      "INSERT INTO outlet_cursor (outlet, door, number, batch_number, turn) "
                      "SELECT $1, $2, $3, $4, batches + 1 FROM outlet WHERE id = $1 "
                      "ON CONFLICT (outlet, door) DO UPDATE SET batch_number = $4, "
                      "turn = excluded.turn",
                      &values, NULL, fault);
}

/* Moves the cursors of the doors of the batch to its end. */
static int move(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->id);
    return hub_db_run(w->store->db,
                      "UPDATE outlet_cursor SET number = batch_number "
                      "WHERE outlet = $1 AND batch_number > number",
                      &values, NULL, fault);
}

/* Fills the batch from the doors that have waited longest. */
static int fill(struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &w->id);
    hub_value_integer(&values, HUB__BATCH_DOORS_MOST);
    int error = hub_db_run(w->store->db,
                           "SELECT d.id, coalesce(c.number, 0), d.acked FROM door d "
                           "LEFT JOIN outlet_cursor c ON c.outlet = $1 AND c.door = d.id "
                           "WHERE d.acked > coalesce(c.number, 0) "
                           "ORDER BY coalesce(c.turn, 0), d.id LIMIT $2",
                           &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows) && w->room > 0; i++) {
        const struct iso_fleet_id door = hub_row_id(rows, i, 0);
        const int64_t after = hub_row_integer(rows, i, 1);
        int64_t end = after;
        error = measure(w, &door, after, hub_row_integer(rows, i, 2), &end, fault);
        error = error ? error : set_end(w, &door, after, end, fault);
    }
    PQclear(rows);
    return error;
}

/* Stores the key of the new batch; if no event has passed the filter there is nothing to hand over,
 * and the cursors move at once. */
static int settle(struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    if (w->room == HUB__BATCH_EVENTS_MOST) {
        return move(w, fault);
    }
    w->key = iso_fleet_id_random();
    hub_value_id(&values, &w->id);
    hub_value_id(&values, &w->key);
    return hub_db_run(w->store->db, "UPDATE outlet SET batch = $2 WHERE id = $1", &values, NULL,
                      fault);
}

/* The limit, which no door reaches beyond, lets PostgreSQL look up each door by the index; else it
 * may read the events of all doors. */
static int load(const struct work *w, struct hub__batch *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &w->id);
    hub_value_text(&values, w->outlet->events);
    hub_value_integer(&values, HUB__BATCH_EVENTS_MOST);
    const int error = hub_db_run(
        w->store->db,
        "SELECT c.door, (SELECT d.name FROM door d WHERE d.id = c.door), e.number, e.time, "
        "e.event, e.record FROM outlet_cursor c CROSS JOIN LATERAL (SELECT e.number, e.time, "
        "e.record->>'event' AS event, e.record::text AS record FROM event e "
        "WHERE e.door = c.door AND e.number > c.number AND e.number <= c.batch_number "
        "AND " PASSES(
            "$2") "ORDER BY e.number LIMIT $3) e "
                  "WHERE c.outlet = $1 AND c.batch_number > c.number ORDER BY c.door, e.number",
        &values, &rows, fault);
    if (!error) {
        *out = (struct hub__batch){.key = w->key, .n = (size_t)PQntuples(rows), .rows = rows};
    }
    return error;
}

/* Everything within one transaction, which holds the row of the outlet: else another process could
 * confirm the batch between its key and its events. */
static int prepare(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &w->id);
    w->room = HUB__BATCH_EVENTS_MOST;
    int error = hub_db_run(w->store->db, "SELECT batch FROM outlet WHERE id = $1 FOR UPDATE",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    const bool exists = PQntuples(rows) > 0;
    w->key = exists ? hub_row_id(rows, 0, 0) : (struct iso_fleet_id){.bytes = {0}};
    PQclear(rows);
    hub__batch_clear(w->out);
    if (exists && iso_fleet_id_is_zero(&w->key)) {
        error = fill(w, fault);
        error = error ? error : settle(w, fault);
    }
    return error || iso_fleet_id_is_zero(&w->key) ? error : load(w, w->out, fault);
}

int hub__batch_take(struct hub_store *store, const struct hub_outlet *outlet,
                    struct hub__batch *out, struct iso_fault *fault)
{
    struct hub__batch batch = {.n = 0};
    struct work w = {.store = store, .outlet = outlet, .id = outlet->id, .out = &batch};
    const int error = hub_db_transaction(store->db, HUB_READ_COMMITTED, prepare, &w, fault);
    if (error) {
        hub__batch_clear(&batch);
        return error;
    }
    *out = batch;
    return 0;
}

static int confirm(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub_values values = {.n = 0};
    PGresult *result = NULL;
    hub_value_id(&values, &w->id);
    hub_value_id(&values, &w->batch->key);
    hub_value_integer(&values, (int64_t)w->batch->n);
    hub_value_integer(&values, w->store->now_s());
    const int error = hub_db_run(w->store->db,
                                 "UPDATE outlet SET batch = NULL, batches = batches + 1, "
                                 "delivered = delivered + $3, delivered_s = $4, failures = 0, "
                                 "next_attempt_ms = 0, trouble = '' WHERE id = $1 AND batch = $2",
                                 &values, &result, fault);
    if (error) {
        return error;
    }
    const bool is_mine = hub_db_changed(result) == 1;
    PQclear(result);
    return is_mine ? move(w, fault) : 0;
}

int hub__batch_done(struct hub_store *store, const struct iso_fleet_id *outlet,
                    const struct hub__batch *batch, struct iso_fault *fault)
{
    struct work w = {.store = store, .id = *outlet, .batch = batch};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, confirm, &w, fault);
}

int hub__batch_failed(struct hub_store *store, const struct iso_fleet_id *outlet, uint64_t failures,
                      int64_t next_attempt_ms, bool stop, const char *trouble,
                      struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, outlet);
    hub_value_integer(&values, (int64_t)failures);
    hub_value_integer(&values, next_attempt_ms);
    hub_value_switch(&values, stop);
    hub_value_text(&values, trouble);
    return hub_db_run(store->db,
                      "UPDATE outlet SET failures = $2, next_attempt_ms = $3, stopped = $4, "
                      "trouble = $5 WHERE id = $1",
                      &values, NULL, fault);
}
