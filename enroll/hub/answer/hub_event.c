/* EVENTS of doors, and reading them. */
#include "enroll/hub/answer/hub_event.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/answer/hub_answer.h"
#include "enroll/hub/answer/hub_sender.h"

struct work {
    struct hub_store *store;
    const struct hub_door *door;
    struct iso_fleet_events events;
    const char *records; /* a JSON array */
    uint64_t acked;
};

/* What is acknowledged is not stored again: it may have been deleted since (hub_prune.h). */
static int insert(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->door->id);
    hub_value_text(&values, w->records);
    return hub_db_run_often(
        w->store->db,
        "INSERT INTO event (door, number, time, record) "
        "SELECT $1, (r ->> 'sequence')::bigint, coalesce(r ->> 'time', ''), r "
        "FROM jsonb_array_elements($2::jsonb) r WHERE (r ->> 'sequence')::bigint > "
        "(SELECT acked FROM door WHERE id = $1) "
        "ON CONFLICT (door, number) DO NOTHING",
        &values, NULL, fault);
}

/* Raises the acknowledged number as far as no number is missing. If the message begins behind the
 * acknowledged number, all its numbers count as stored. After them come records of earlier messages
 * that were stored already. The row of the door is locked meanwhile, so that two messages do not
 * change the number at once. */
static int acknowledge(struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &w->door->id);
    hub_value_integer(&values, (int64_t)w->events.first);
    hub_value_integer(&values, (int64_t)w->events.last);
    const int error = hub_db_run_often(
        w->store->db,
        "WITH reached AS (SELECT CASE WHEN $2 <= acked + 1 THEN greatest(acked, $3) ELSE acked END "
        "AS n FROM door WHERE id = $1), "
        "behind AS (SELECT number, row_number() OVER (ORDER BY number) AS nth FROM event "
        "WHERE door = $1 AND number > (SELECT n FROM reached)) "
        "UPDATE door SET acked = (SELECT n + (SELECT count(*) FROM behind "
        "WHERE number = (SELECT n FROM reached) + nth) FROM reached) WHERE id = $1 RETURNING acked",
        &values, &rows, fault);
    if (!error) {
        w->acked = (uint64_t)hub_row_integer(rows, 0, 0);
        PQclear(rows);
    }
    return error;
}

static int store_events(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->door->id);
    int error = hub_db_run_often(
        w->store->db, "SELECT id FROM door WHERE id = $1 FOR NO KEY UPDATE", &values, NULL, fault);
    error = error ? error : insert(w, fault);
    return error ? error : acknowledge(w, fault);
}

/* Reads the lines into a JSON array. Their numbers rise, and are within the range of the message.
 */
static int take_lines(const struct iso_fleet_events *events, const struct iso_fleet_bytes *lines,
                      json_t *records)
{
    const char *at = (const char *)lines->bytes, *end = at + lines->size;
    uint64_t before = events->first - 1;
    while (at < end) {
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        json_t *record = newline ? json_loadb(at, (size_t)(newline - at), 0, NULL) : NULL;
        const json_t *number = json_object_get(record, "sequence");
        const json_t *time = json_object_get(record, "time");
        const uint64_t n = json_is_integer(number) && json_integer_value(number) > 0
                               ? (uint64_t)json_integer_value(number)
                               : 0;
        if (n <= before || n > events->last || (time && !json_is_string(time)) ||
            json_array_append_new(records, record)) {
            json_decref(record);
            return -EBADMSG;
        }
        before = n;
        at = newline + 1;
    }
    return 0;
}

/* The records of a message as the text of a JSON array, which the caller frees. */
static int records_of(const struct iso_fleet_events *events, const struct iso_fleet_bytes *lines,
                      char **out)
{
    if (events->first == 0 || events->last < events->first || events->last > INT64_MAX / 2) {
        return -EBADMSG;
    }
    json_t *records = json_array();
    const int error = records ? take_lines(events, lines, records) : -ENOMEM;
    char *text = error ? NULL : json_dumps(records, JSON_COMPACT);
    json_decref(records);
    if (!text) {
        return error ? error : -ENOMEM;
    }
    *out = text;
    return 0;
}

static int emit_ack(const struct work *w, const struct hub_emit *emit, struct iso_fault *fault)
{
    const struct iso_fleet_ack ack = {.door = w->door->id, .number = w->acked};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    char topic[ISO_FLEET_TOPIC_SIZE];
    int error = iso_fleet_make_ack(&ack, &w->store->keys.signs, &bytes);
    if (error) {
        return iso_fault_set(fault, error, "door %s: no memory", w->door->name);
    }
    error = emit->emit(emit->context, iso_fleet_topic_in(&w->door->id, topic), bytes.bytes,
                       bytes.size, false);
    iso_fleet_bytes_free(&bytes);
    return error ? iso_fault_set(fault, error, "door %s: an acknowledgement could not be sent",
                                 w->door->name)
                 : 0;
}

int hub_take_events(struct hub_store *store, const void *bytes, size_t size,
                    const struct hub_emit *emit, struct iso_fault *fault)
{
    struct hub_door door;
    struct iso_fleet_bytes lines = {.bytes = NULL};
    char *records = NULL;
    int error = hub__sender(store, bytes, size, &door, fault);
    if (error) {
        return error;
    }
    struct work w = {.store = store, .door = &door};
    error = iso_fleet_read_events(bytes, size, door.signs, &store->keys.receives, &w.events,
                                  &lines);
    error = error ? error : records_of(&w.events, &lines, &records);
    iso_fleet_bytes_free(&lines);
    if (error) {
        return hub__sender_fault(&door, "message of events", error, fault);
    }
    w.records = records;
    error = hub_db_transaction(store->db, HUB_READ_COMMITTED, store_events, &w, fault);
    free(records);
    return error ? error : emit_ack(&w, emit, fault);
}

/* The newest events of a filter: $1 door, $2 person, $3 event, $4 since, $5 how many, $6 until, and
 * $7, $8, $9 the place before which they are. */
static const char each_sql[] =
    "SELECT e.door, d.name, e.number, e.time, e.record::text FROM "
    "(SELECT * FROM event WHERE ($1::uuid IS NULL OR door = $1) "
    "AND ($2::text IS NULL OR record ->> 'person' = $2) "
    "AND ($3::text IS NULL OR record ->> 'event' = $3) "
    "AND ($4::text IS NULL OR time >= $4) AND ($6::text IS NULL OR time < $6) "
    "AND ($7::text IS NULL OR (time, number, door) < ($7, $8, $9)) "
    "ORDER BY time DESC, number DESC, door DESC LIMIT $5) e "
    "LEFT JOIN door d ON d.id = e.door ORDER BY e.time, e.number, e.door";

int hub_event_each(struct hub_store *store, const struct hub_event_filter *filter,
                   int (*each)(void *context, const struct hub_event *event), void *context,
                   struct iso_fault *fault)
{
    const struct hub_event_place *before = filter->before;
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, filter->door);
    hub_value_text(&values, filter->person);
    hub_value_text(&values, filter->event);
    hub_value_text(&values, filter->since);
    hub_value_integer(&values, filter->most ? (int64_t)filter->most : INT64_MAX);
    hub_value_text(&values, filter->until);
    hub_value_text(&values, before ? before->time : NULL);
    hub_value_integer(&values, before ? (int64_t)before->number : 0);
    hub_value_id(&values, before ? &before->door : NULL);
    int error = hub_db_run(store->db, each_sql, &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct hub_event event = {.door = hub_row_id(rows, i, 0),
                                        .door_name = hub_row_text(rows, i, 1),
                                        .number = (uint64_t)hub_row_integer(rows, i, 2),
                                        .time = hub_row_text(rows, i, 3),
                                        .record = hub_row_text(rows, i, 4)};
        error = each(context, &event);
    }
    PQclear(rows);
    return error;
}
