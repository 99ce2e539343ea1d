/* QUESTION of a door: its report is stored, and LEASE, KEY and UPDATE answer it. */
#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/answer/hub_grant.h"
#include "enroll/hub/answer/hub_sender.h"
#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/update/update_step.h"

struct work {
    struct hub_store *store;
    const struct hub_door *door;
    const struct iso_fleet_question *question;
    char *health; /* a JSON object, or "" */
    struct hub__door_zones *zones;
    uint64_t acked;
    bool is_ordered; /* the door shall install an update */
    struct iso_fleet_update update;
};

/* The place of a zone in the question, or NULL. */
static const struct iso_fleet_place *place_in(const struct iso_fleet_question *question,
                                              const struct iso_fleet_id *zone)
{
    for (size_t i = 0; i < question->n; i++) {
        if (iso_fleet_id_is_same(&question->places[i].zone, zone)) {
            return &question->places[i];
        }
    }
    return NULL;
}

/* Numbers above this do not fit into the database; no honest door comes so far. */
static bool is_too_high(const struct iso_fleet_question *question)
{
    bool high = question->last_event > INT64_MAX;
    for (size_t i = 0; i < question->n; i++) {
        high = high || question->places[i].epoch > INT64_MAX / 2 ||
               question->places[i].sequence > INT64_MAX / 2;
    }
    return high;
}

static int store_report(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->door->id);
    hub_value_integer(&values, w->store->now_s());
    hub_value_integer(&values, w->question->time_s);
    hub_value_integer(&values, w->question->algorithm);
    hub_value_integer(&values, (int64_t)w->question->last_event);
    hub_value_text(&values, w->health);
    return hub_db_run_often(w->store->db,
                            "WITH p AS (DELETE FROM door_place WHERE door = $1 AND zone NOT IN "
                            "(SELECT zone FROM door_zone WHERE door = $1)) "
                            "UPDATE door SET online = true, reported_s = $2, door_time_s = $3, "
                            "algorithm = $4, last_event = $5, health = $6 WHERE id = $1",
                            &values, NULL, fault);
}

static int store_place(const struct work *w, const struct hub__door_zone *zone,
                       struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->door->id);
    hub_value_id(&values, &zone->place.zone);
    if (!zone->known) {
        return hub_db_run_often(w->store->db,
                                "DELETE FROM door_place WHERE door = $1 AND zone = $2", &values,
                                NULL, fault);
    }
    hub_value_integer(&values, (int64_t)zone->reported.epoch);
    hub_value_integer(&values, (int64_t)zone->reported.sequence);
    hub_value_bytes(&values, zone->reported.digest, sizeof zone->reported.digest);
    return hub_db_run_often(w->store->db,
                            "INSERT INTO door_place (door, zone, epoch, sequence, digest) "
                            "VALUES ($1, $2, $3, $4, $5) ON CONFLICT (door, zone) DO UPDATE SET "
                            "epoch = $3, sequence = $4, digest = $5",
                            &values, NULL, fault);
}

/* The digest that this database has for a sequence of the zone; *found is false if it does not have
 * the delta. */
static int digest_at(const struct work *w, const struct hub__door_zone *zone,
                     uint8_t digest[ISO_FLEET_DIGEST_BYTES], bool *found, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    *found = true;
    if (zone->reported.sequence == zone->place.sequence) {
        memcpy(digest, zone->place.digest, ISO_FLEET_DIGEST_BYTES);
        return 0;
    }
    if (zone->reported.sequence == zone->base.sequence) {
        memcpy(digest, zone->base.digest, ISO_FLEET_DIGEST_BYTES);
        return 0;
    }
    hub_value_id(&values, &zone->place.zone);
    hub_value_integer(&values, (int64_t)zone->reported.sequence);
    const int error = hub_db_run_often(w->store->db,
                                       "SELECT digest FROM delta WHERE zone = $1 AND sequence = $2 "
                                       "UNION ALL SELECT digest FROM delta_digest WHERE zone = $1 "
                                       "AND sequence = $2",
                                       &values, &rows, fault);
    if (error) {
        return error;
    }
    *found = PQntuples(rows) > 0 && hub_row_copy(rows, 0, 0, digest, ISO_FLEET_DIGEST_BYTES) == 0;
    PQclear(rows);
    return 0;
}

/* Whether the door knows more than this database. What it has from before a reset does not count,
 * because the KEY of the reset replaces it. */
static int is_ahead(const struct work *w, const struct hub__door_zone *zone, bool *ahead,
                    struct iso_fault *fault)
{
    const struct iso_fleet_place *there = &zone->reported, *here = &zone->place;
    uint8_t digest[ISO_FLEET_DIGEST_BYTES];
    bool found = false;
    *ahead = false;
    if (!zone->known || there->epoch < zone->reset_epoch) {
        return 0;
    }
    if (there->epoch > here->epoch || there->sequence > here->sequence) {
        *ahead = true;
        return 0;
    }
    if (there->sequence == 0) {
        return 0;
    }
    const int error = digest_at(w, zone, digest, &found, fault);
    *ahead = !error && found && memcmp(digest, there->digest, sizeof digest) != 0;
    return error;
}

/* Marks a zone, and records which door is ahead: an administrator has to judge whether the database
 * is old or the door lies. */
static int mark_behind(const struct work *w, struct hub__door_zone *zone, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &zone->place.zone);
    zone->behind = true;
    int error = hub_db_run(w->store->db,
                           "UPDATE zone SET behind = true WHERE id = $1 AND NOT behind "
                           "RETURNING name",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) > 0) {
        error = hub__act_add(w->store, "zone-behind", hub_row_text(rows, 0, 0), NULL,
                             json_pack("{s:s,s:I,s:I}", "door", w->door->name, "epoch",
                                       (json_int_t)zone->reported.epoch, "sequence",
                                       (json_int_t)zone->reported.sequence),
                             fault);
    }
    PQclear(rows);
    return error;
}

/* Behind the lock of the zone's row nothing changes between the comparison and the mark. It is
 * taken only if the door seems to be ahead, so that doors do not wait for each other. */
static int confirm_ahead(const struct work *w, struct hub__door_zone *zone, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    struct hub__door_zones now;
    bool ahead = false;
    hub_value_id(&values, &zone->place.zone);
    int error = hub_db_run(w->store->db, "SELECT id FROM zone WHERE id = $1 FOR NO KEY UPDATE",
                           &values, NULL, fault);
    error = error ? error : hub__door_zones(w->store, &w->door->id, &now, fault);
    if (error) {
        return error;
    }
    for (size_t i = 0; !error && i < now.n; i++) {
        if (iso_fleet_id_is_same(&now.zones[i].place.zone, &zone->place.zone)) {
            now.zones[i].known = zone->known;
            now.zones[i].reported = zone->reported;
            *zone = now.zones[i];
            error = is_ahead(w, zone, &ahead, fault);
            error = error || !ahead ? error : mark_behind(w, zone, fault);
        }
    }
    hub__door_zones_wipe(&now);
    return error;
}

/* So far no lost database was ahead. The bound keeps a door that lies from using up the numbers. */
static bool is_impossible(const struct hub__door_zone *zone)
{
    static const uint64_t most = UINT64_C(1) << 32;
    return zone->known && (zone->reported.epoch > zone->place.epoch + most ||
                           zone->reported.sequence > zone->place.sequence + most);
}

static int take_places(const struct work *w, struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < w->zones->n; i++) {
        struct hub__door_zone *zone = &w->zones->zones[i];
        const struct iso_fleet_place *place = place_in(w->question, &zone->place.zone);
        bool ahead = false;
        zone->known = place;
        if (place) {
            zone->reported = *place;
        }
        error = is_impossible(zone) ? hub__sender_fault(w->door, "question", -EBADMSG, fault)
                                    : is_ahead(w, zone, &ahead, fault);
        error = error || !ahead ? error : confirm_ahead(w, zone, fault);
        error = error ? error : store_place(w, zone, fault);
    }
    return error;
}

static int take_report(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    /* A report that a crash loses is made again, so many doors need not wait for the disk. */
    int error = hub_db_script(w->store->db, "SET LOCAL synchronous_commit = off", fault);
    error = error ? error : store_report(w, fault);
    error = error ? error : hub__door_zones(w->store, &w->door->id, w->zones, fault);
    error = error ? error : take_places(w, fault);
    hub_value_id(&values, &w->door->id);
    error = error ? error
                  : hub_db_run_often(w->store->db, "SELECT acked FROM door WHERE id = $1", &values,
                                     &rows, fault);
    if (!error) {
        w->acked = (uint64_t)hub_row_integer(rows, 0, 0);
        PQclear(rows);
    }
    return error ? error
                 : hub__update_step(w->store, &w->door->id, w->health, &w->is_ordered, &w->update,
                                    fault);
}

/* A door has one lease for the people of all its zones: the strictest. */
static uint32_t shortest_lease(const struct hub__door_zones *zones)
{
    uint32_t shortest = zones->zones[0].lease_s;
    for (size_t i = 1; i < zones->n; i++) {
        shortest = zones->zones[i].lease_s < shortest ? zones->zones[i].lease_s : shortest;
    }
    return shortest; /* 0, never without the hub, is the strictest of all */
}

static int emit_lease(const struct work *w, const struct hub_emit *emit, struct iso_fault *fault)
{
    struct iso_fleet_lease lease = {
        .door = w->door->id, .time_s = w->store->now_s(), .acked = w->acked, .n = w->zones->n};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    char topic[ISO_FLEET_TOPIC_SIZE];
    memcpy(lease.nonce, w->question->nonce, sizeof lease.nonce);
    for (size_t i = 0; i < lease.n; i++) {
        lease.places[i] = w->zones->zones[i].place;
    }
    if (lease.n > 0) {
        lease.lease_s = shortest_lease(w->zones);
        lease.local_people = w->zones->zones[0].local_people;
    }
    int error = iso_fleet_make_lease(&lease, &w->store->keys.signs, &bytes);
    if (error) {
        return iso_fault_set(fault, error, "door %s: a lease: no memory", w->door->name);
    }
    error = emit->emit(emit->context, iso_fleet_topic_in(&w->door->id, topic), bytes.bytes,
                       bytes.size, false);
    iso_fleet_bytes_free(&bytes);
    return error ? iso_fault_set(fault, error, "door %s: a lease could not be sent", w->door->name)
                 : 0;
}

static int emit_update(const struct work *w, const struct hub_emit *emit, struct iso_fault *fault)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    char topic[ISO_FLEET_TOPIC_SIZE];
    struct iso_fleet_update order = w->update;
    memcpy(order.nonce, w->question->nonce, sizeof order.nonce);
    int error = iso_fleet_make_update(&order, &w->store->keys.signs, &bytes);
    if (error) {
        return iso_fault_set(fault, error, "door %s: an order: no memory", w->door->name);
    }
    error = emit->emit(emit->context, iso_fleet_topic_in(&w->door->id, topic), bytes.bytes,
                       bytes.size, false);
    iso_fleet_bytes_free(&bytes);
    return error ? iso_fault_set(fault, error, "door %s: an order could not be sent", w->door->name)
                 : 0;
}

/* The LEASE comes first, because a door takes a KEY only for a zone that a LEASE has listed, and an
 * order for an update holds until the next LEASE. */
static int answer(const struct work *w, const struct hub_emit *emit, struct iso_fault *fault)
{
    int error = emit_lease(w, emit, fault);
    for (size_t i = 0; !error && i < w->zones->n; i++) {
        if (hub__wants_key(&w->zones->zones[i])) {
            error = hub__emit_key(w->store, w->door, &w->zones->zones[i], emit, fault);
        }
    }
    return error || !w->is_ordered ? error : emit_update(w, emit, fault);
}

/* The health as the database stores it: a JSON object, or nothing. */
static char *health_of(const struct iso_fleet_question *question)
{
    json_t *object = json_loadb(question->health, question->health_length, 0, NULL);
    char *text = json_is_object(object) ? json_dumps(object, JSON_COMPACT) : NULL;
    json_decref(object);
    if (text && strlen(text) > ISO_FLEET_HEALTH_MAX) {
        free(text);
        text = NULL;
    }
    return text ? text : strdup("");
}

int hub_take_question(struct hub_store *store, const void *bytes, size_t size,
                      const struct hub_emit *emit, struct iso_fault *fault)
{
    struct hub_door door;
    struct iso_fleet_question question;
    struct hub__door_zones zones;
    int error = hub__sender(store, bytes, size, &door, fault);
    if (error) {
        return error;
    }
    error = iso_fleet_read_question(bytes, size, door.signs, &question);
    if (error || is_too_high(&question)) {
        return hub__sender_fault(&door, "question", error ? error : -EBADMSG, fault);
    }
    struct work w = {.store = store,
                     .door = &door,
                     .question = &question,
                     .health = health_of(&question),
                     .zones = &zones};
    error = w.health ? hub_db_transaction(store->db, HUB_READ_COMMITTED, take_report, &w, fault)
                     : iso_fault_set(fault, -ENOMEM, "door %s: no memory", door.name);
    error = error ? error : answer(&w, emit, fault);
    free(w.health);
    hub__door_zones_wipe(&zones);
    return error;
}
