#include "enroll/hub/people/hub_request.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/people/hub_person_rows.h"
#include "enroll/hub/people/hub_spread.h"
#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/store/hub_door.h"
#include "firmware/contract/person_name.h"

static const char request_use[] = "request";

struct work {
    struct hub_store *store;
    struct iso_fleet_id person, door;
    const struct iso_fleet_person *content;
    const struct iso_fleet_id *zones;
    size_t n_zones;
    char name[ISO_FLEET_NAME_MAX + 1];
};

/* ---- storing ---- */

/* Tells the door's home zone to remove the person. */
static int remove_again(struct work *w, struct iso_fault *fault)
{
    struct hub_door door;
    struct hub__zones home = {.n = 1};
    const int error = hub_door_get(w->store, &w->door, &door, fault);
    if (error || door.n_zones == 0) {
        return error;
    }
    home.ids[0] = door.zones[0];
    return hub__person_remove(w->store, &w->person, &home, fault);
}

/* What to do about a person whose request with these templates was decided. */
static int repeat_decision(struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &w->person);
    const int error = hub_db_run(w->store->db,
                                 "SELECT r.state = 2 OR (r.state = 1 AND p.id IS NULL) "
                                 "FROM request r LEFT JOIN person p ON p.id = r.person "
                                 "WHERE r.person = $1",
                                 &values, &rows, fault);
    if (error) {
        return error;
    }
    const bool is_out = PQntuples(rows) > 0 && hub_row_switch(rows, 0, 0);
    PQclear(rows);
    return is_out ? remove_again(w, fault) : 0;
}

static int insert(struct work *w, const struct iso_fleet_bytes *sealed, int64_t *changed,
                  struct iso_fault *fault)
{
    uint8_t digest[ISO_FLEET_DIGEST_BYTES];
    struct hub_values values = {.n = 0};
    PGresult *result = NULL;
    iso_fleet_templates_digest(w->content, digest);
    hub_value_id(&values, &w->person);
    hub_value_id(&values, &w->door);
    hub_value_text(&values, w->name);
    hub_value_bytes(&values, digest, sizeof digest);
    hub_value_bytes(&values, sealed->bytes, sealed->size);
    hub_value_integer(&values, w->store->now_s());
    const int error = hub_db_run(w->store->db,
                                 "INSERT INTO request (person, door, name, digest, sealed, time_s) "
                                 "VALUES ($1, $2, $3, $4, $5, $6) ON CONFLICT (person) DO UPDATE "
                                 "SET door = $2, name = $3, digest = $4, sealed = $5, time_s = $6, "
                                 "state = 0 WHERE request.digest <> $4",
                                 &values, &result, fault);
    if (!error) {
        *changed = hub_db_changed(result);
        PQclear(result);
    }
    return error;
}

static int add(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct iso_fleet_bytes plain = {.bytes = NULL}, sealed = {.bytes = NULL};
    int64_t changed = 0;
    iso_fleet_put_person(&plain, w->content);
    int error = plain.error;
    error = error ? error
                  : hub_keys_seal(&w->store->keys, request_use, &w->person, plain.bytes, plain.size,
                                  &sealed);
    error = error ? iso_fault_set(fault, error, "%s: no memory", w->name)
                  : insert(w, &sealed, &changed, fault);
    iso_fleet_bytes_free(&plain);
    iso_fleet_bytes_free(&sealed);
    return error || changed ? error : repeat_decision(w, fault);
}

int hub_request_add(struct hub_store *store, const struct iso_fleet_id *door,
                    const struct iso_fleet_person *person, struct iso_fault *fault)
{
    struct work w = {.store = store, .person = person->id, .door = *door, .content = person};
    if (person->name_length >= sizeof w.name) {
        return iso_fault_set(fault, -EINVAL, "a request: the name is too long");
    }
    (void)snprintf(w.name, sizeof w.name, "%.*s", (int)person->name_length, person->name);
    if (!iso_person_name_can_be_stored(w.name)) {
        return iso_fault_set(fault, -EINVAL, "a request: its name cannot be stored");
    }
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, add, &w, fault);
}

/* ---- deciding ---- */

/* Locks a pending request, and opens the person in it. The caller frees `plain`. */
static int lock(struct work *w, struct iso_fleet_bytes *plain, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    size_t size = 0;
    hub_value_id(&values, &w->person);
    int error = hub_db_run(w->store->db,
                           "SELECT door, name, state, sealed FROM request WHERE person = $1 "
                           "FOR NO KEY UPDATE",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    if (PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "there is no such request");
    } else if (hub_row_integer(rows, 0, 2) != HUB_REQUEST_PENDING) {
        error = iso_fault_set(fault, -EALREADY, "%s: the request was decided before",
                              hub_row_text(rows, 0, 1));
    } else {
        const uint8_t *sealed = hub_row_bytes(rows, 0, 3, &size);
        w->door = hub_row_id(rows, 0, 0);
        (void)snprintf(w->name, sizeof w->name, "%s", hub_row_text(rows, 0, 1));
        error = hub_keys_open(&w->store->keys, request_use, &w->person, sealed, size, plain);
        error = error ? iso_fault_set(fault, error == -ENOMEM ? error : -EBADMSG,
                                      "%s: the request cannot be opened", w->name)
                      : 0;
    }
    PQclear(rows);
    return error;
}

/* Marks the request as decided; its templates are not needed any more. */
static int decide(struct work *w, enum hub_request_state state, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->person);
    hub_value_integer(&values, state);
    const int error = hub_db_run(w->store->db,
                                 "UPDATE request SET state = $2, sealed = NULL WHERE person = $1",
                                 &values, NULL, fault);
    return error
               ? error
               : hub__act_add(w->store,
                              state == HUB_REQUEST_APPROVED ? "request-approve" : "request-reject",
                              w->name, NULL, NULL, fault);
}

/* The zones of a person who becomes one of the fleet: those that were named, else the home zone of
 * the door. */
static int new_zones(const struct work *w, struct hub__zones *zones, struct iso_fault *fault)
{
    struct hub_door door;
    if (w->n_zones > 0) {
        zones->n = w->n_zones < HUB_PERSON_ZONES_MAX ? w->n_zones : HUB_PERSON_ZONES_MAX;
        memcpy(zones->ids, w->zones, zones->n * sizeof *zones->ids);
        return 0;
    }
    const int error = hub_door_get(w->store, &w->door, &door, fault);
    if (error) {
        return error;
    }
    if (door.n_zones == 0) {
        return iso_fault_set(fault, -EINVAL, "%s: its door has no zone any more; name a zone",
                             w->name);
    }
    zones->n = 1;
    zones->ids[0] = door.zones[0];
    return 0;
}

/* Puts the templates of a request into the person of the fleet: a new one, or the person who is
 * one already, whose name, limits and zones stay. */
static int put(struct work *w, struct iso_fleet_person *asked, struct iso_fault *fault)
{
    struct hub__person known;
    struct hub__zones zones = {.n = 0};
    int error = hub__person_lock(w->store, &w->person, &zones, NULL, fault);
    if (error == -ENOENT) {
        error = new_zones(w, &zones, fault);
        asked->revision = 0;
        return error ? error : hub_person_put(w->store, asked, zones.ids, zones.n, fault);
    }
    error = error ? error : hub__person_load(w->store, &w->person, &known, fault);
    if (error) {
        return error;
    }
    struct iso_fleet_person both = known.person;
    both.n = asked->n;
    memcpy(both.templates, asked->templates, sizeof both.templates);
    error = hub_person_put(w->store, &both, zones.ids, zones.n, fault);
    hub__person_free(&known);
    return error;
}

static int approve(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    struct iso_fleet_person asked;
    int error = lock(w, &plain, fault);
    if (error) {
        return error;
    }
    error = iso_fleet_read_person(plain.bytes, plain.size, &asked);
    error = error ? iso_fault_set(fault, -EBADMSG, "%s: the request is damaged", w->name)
                  : put(w, &asked, fault);
    error = error ? error : decide(w, HUB_REQUEST_APPROVED, fault);
    iso_fleet_bytes_free(&plain);
    return error;
}

int hub_request_approve(struct hub_store *store, const struct iso_fleet_id *person,
                        const struct iso_fleet_id *zones, size_t n_zones, struct iso_fault *fault)
{
    struct work w = {.store = store, .person = *person, .zones = zones, .n_zones = n_zones};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, approve, &w, fault);
}

static int reject(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    int error = lock(w, &plain, fault);
    iso_fleet_bytes_free(&plain);
    error = error ? error : decide(w, HUB_REQUEST_REJECTED, fault);
    return error ? error : repeat_decision(w, fault);
}

int hub_request_reject(struct hub_store *store, const struct iso_fleet_id *person,
                       struct iso_fault *fault)
{
    struct work w = {.store = store, .person = *person};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, reject, &w, fault);
}

/* ---- reading ---- */

#define COLUMNS                                                                  \
    "SELECT r.person, r.door, r.name, d.name, r.time_s, r.state FROM request r " \
    "JOIN door d ON d.id = r.door "

static struct hub_request take(const PGresult *rows, int row)
{
    struct hub_request request = {.person = hub_row_id(rows, row, 0),
                                  .door = hub_row_id(rows, row, 1),
                                  .time_s = hub_row_integer(rows, row, 4),
                                  .state = (enum hub_request_state)hub_row_integer(rows, row, 5)};
    (void)snprintf(request.name, sizeof request.name, "%s", hub_row_text(rows, row, 2));
    (void)snprintf(request.door_name, sizeof request.door_name, "%s", hub_row_text(rows, row, 3));
    return request;
}

int hub_request_each(struct hub_store *store, bool all,
                     int (*each)(void *context, const struct hub_request *request), void *context,
                     struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_switch(&values, all);
    int error = hub_db_run(store->db, COLUMNS "WHERE $1 OR r.state = 0 ORDER BY r.time_s, r.person",
                           &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct hub_request request = take(rows, i);
        error = each(context, &request);
    }
    PQclear(rows);
    return error;
}

int hub_request_find(struct hub_store *store, const char *name_or_id, struct hub_request *out,
                     struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    struct iso_fleet_id id;
    PGresult *rows = NULL;
    const bool is_id = iso_fleet_id_read(name_or_id, &id) == 0;
    hub_value_id(&values, is_id ? &id : NULL);
    hub_value_text(&values, is_id ? NULL : name_or_id);
    int error = hub_db_run(store->db,
                           COLUMNS "WHERE r.person = $1 OR (r.name = $2 AND r.state = 0)", &values,
                           &rows, fault);
    if (error) {
        return error;
    }
    if (PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "%s: there is no such request", name_or_id);
    } else if (PQntuples(rows) > 1) {
        error = iso_fault_set(fault, -EINVAL, "%s: there are %d requests of this name; use the id",
                              name_or_id, PQntuples(rows));
    } else {
        *out = take(rows, 0);
    }
    PQclear(rows);
    return error;
}
