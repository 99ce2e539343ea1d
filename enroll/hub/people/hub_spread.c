#include "enroll/hub/people/hub_spread.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/people/hub_person_rows.h"
#include "enroll/hub/store/hub_change.h"

static int read_zones(struct hub_store *store, const struct iso_fleet_id *id,
                      struct hub__zones *zones, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, id);
    const int error = hub_db_run(store->db,
                                 "SELECT zone FROM person_zone WHERE person = $1 ORDER BY zone",
                                 &values, &rows, fault);
    if (error) {
        return error;
    }
    zones->n = 0;
    for (int i = 0; i < PQntuples(rows) && zones->n < HUB_PERSON_ZONES_MAX; i++) {
        zones->ids[zones->n++] = hub_row_id(rows, i, 0);
    }
    PQclear(rows);
    return 0;
}

int hub__person_lock(struct hub_store *store, const struct iso_fleet_id *id,
                     struct hub__zones *zones, json_t **json, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, id);
    int error = hub_db_run(store->db, "SELECT id FROM person WHERE id = $1 FOR NO KEY UPDATE",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    const int n = PQntuples(rows);
    PQclear(rows);
    if (n == 0) {
        return iso_fault_set(fault, -ENOENT, "there is no such person");
    }
    error = read_zones(store, id, zones, fault);
    if (!error && json) {
        *json = hub__person_json(store, id);
    }
    return error;
}

static int find(struct hub_store *store, const struct iso_fleet_id *id, struct hub_person *out)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    return hub_person_find(store, iso_fleet_id_text(id, text), out, NULL);
}

struct hub__person_text hub__person_name(struct hub_store *store, const struct iso_fleet_id *id)
{
    struct hub_person person;
    struct hub__person_text name = {.text = ""};
    if (find(store, id, &person) == 0) {
        (void)snprintf(name.text, sizeof name.text, "%s", person.name);
    }
    return name;
}

json_t *hub__person_json(struct hub_store *store, const struct iso_fleet_id *id)
{
    struct hub_person person;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    if (find(store, id, &person)) {
        return NULL;
    }
    json_t *zones = json_array();
    for (size_t i = 0; i < person.n_zones; i++) {
        (void)json_array_append_new(zones, json_string(person.zone_names[i]));
    }
    return json_pack("{s:s,s:s,s:I,s:I,s:I,s:b,s:I,s:o}", "id", iso_fleet_id_text(id, text), "name",
                     person.name, "revision", (json_int_t)person.revision, "valid_from_s",
                     (json_int_t)person.valid_from_s, "valid_until_s",
                     (json_int_t)person.valid_until_s, "offline_ok", person.offline_ok, "templates",
                     (json_int_t)person.templates, "zones", zones);
}

int hub__person_put_zones(struct hub_store *store, const struct iso_fleet_id *id,
                          const struct iso_fleet_id *zones, size_t n, struct iso_fault *fault)
{
    struct hub_values person = {.n = 0};
    hub_value_id(&person, id);
    int error = hub_db_run(store->db, "DELETE FROM person_zone WHERE person = $1", &person, NULL,
                           fault);
    for (size_t i = 0; !error && i < n; i++) {
        struct hub_values values = {.n = 0};
        hub_value_id(&values, id);
        hub_value_id(&values, &zones[i]);
        error = hub_db_run(store->db,
                           "INSERT INTO person_zone (person, zone) VALUES ($1, $2) "
                           "ON CONFLICT DO NOTHING",
                           &values, NULL, fault);
        if (error == -ENOENT) {
            return iso_fault_set(fault, error, "there is no such zone");
        }
    }
    return error;
}

/* Appends one change to zones, which are in the order of locks. */
static int append_all(struct hub_store *store, const struct hub__zones *zones,
                      const struct iso_fleet_change *change, struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < zones->n; i++) {
        error = hub__zone_change(store, &zones->ids[i], change, fault);
    }
    return error;
}

static bool is_in(const struct hub__zones *zones, const struct iso_fleet_id *id)
{
    for (size_t i = 0; i < zones->n; i++) {
        if (iso_fleet_id_is_same(&zones->ids[i], id)) {
            return true;
        }
    }
    return false;
}

static int raise_revision(struct hub_store *store, const struct iso_fleet_id *id,
                          struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, id);
    return hub_db_run(store->db,
                      "UPDATE person SET revision = nextval('person_revision') WHERE id = $1",
                      &values, NULL, fault);
}

/* All zones of two lists, in the order of locks. */
static size_t both(const struct hub__zones *a, const struct hub__zones *b,
                   struct iso_fleet_id out[2 * HUB_PERSON_ZONES_MAX])
{
    memcpy(out, a->ids, a->n * sizeof *out);
    memcpy(out + a->n, b->ids, b->n * sizeof *out);
    return hub__ids_in_order(out, a->n + b->n);
}

int hub__person_spread(struct hub_store *store, const struct iso_fleet_id *id,
                       const struct hub__zones *before, struct iso_fault *fault)
{
    struct hub__person person;
    struct hub__zones now = {.n = 0};
    struct iso_fleet_id all[2 * HUB_PERSON_ZONES_MAX];
    int error = raise_revision(store, id, fault);
    error = error ? error : read_zones(store, id, &now, fault);
    error = error ? error : hub__person_load(store, id, &person, fault);
    if (error) {
        return error;
    }
    struct iso_fleet_change change = {.person = person.person};
    const size_t n = both(before, &now, all);
    for (size_t i = 0; !error && i < n; i++) {
        change.kind = is_in(&now, &all[i]) ? ISO_FLEET_PUT : ISO_FLEET_REMOVE;
        error = hub__zone_change(store, &all[i], &change, fault);
    }
    hub__person_free(&person);
    return error;
}

int hub__person_remove(struct hub_store *store, const struct iso_fleet_id *id,
                       const struct hub__zones *zones, struct iso_fault *fault)
{
    struct iso_fleet_change change = {.kind = ISO_FLEET_REMOVE, .person.id = *id};
    PGresult *rows = NULL;
    const int error = hub_db_run(store->db, "SELECT nextval('person_revision')", NULL, &rows,
                                 fault);
    if (error) {
        return error;
    }
    change.person.revision = (uint64_t)hub_row_integer(rows, 0, 0);
    PQclear(rows);
    return append_all(store, zones, &change, fault);
}
