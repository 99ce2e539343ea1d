/* Brings one person to what the directory says. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/directory/directory_rows.h"
#include "enroll/hub/people/hub_spread.h"
#include "enroll/hub/store/hub_act.h"
#include "firmware/contract/name_folding.h"

struct work {
    struct hub_store *store;
    const char *source;
    const struct hub_named *named;
    bool is_named, linked;
    const struct iso_fleet_id *link; /* NULL: whom the directory and a request name */

    /* within the transaction */
    struct iso_fleet_id row, person;
    int64_t added_s;
    bool is_linked;
    struct hub__zones old; /* which the directory gave before */
};

/* ---- the row of the list ---- */

static int upsert(struct work *w, const char *folded, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    const struct iso_fleet_id id = iso_fleet_id_random();
    hub_value_id(&values, &id);
    hub_value_text(&values, w->source);
    hub_value_text(&values, w->named->external);
    hub_value_text(&values, w->named->name);
    hub_value_text(&values, folded);
    hub_value_switch(&values, w->named->active);
    hub_value_integer(&values, w->named->from_s);
    hub_value_integer(&values, w->named->until_s);
    hub_value_switch(&values, w->is_named);
    hub_value_integer(&values, w->store->now_s());
    const int error = hub_db_run(
        w->store->db,
        "INSERT INTO directory (id, source, external, name, folded, active, valid_from_s, "
        "valid_until_s, named, added_s) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10) "
        "ON CONFLICT (source, external) DO UPDATE SET name = $4, folded = $5, active = $6, "
        "valid_from_s = $7, valid_until_s = $8, named = $9 RETURNING id, added_s, person",
        &values, &rows, fault);
    if (!error) {
        w->row = hub_row_id(rows, 0, 0);
        w->added_s = hub_row_integer(rows, 0, 1);
        w->is_linked = !PQgetisnull(rows, 0, 2);
        w->person = hub_row_id(rows, 0, 2);
        PQclear(rows);
    }
    return error;
}

static int read_old_zones(struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &w->row);
    const int error = hub_db_run(w->store->db,
                                 "SELECT zone FROM directory_zone WHERE directory = $1", &values,
                                 &rows, fault);
    w->old.n = 0;
    for (int i = 0; !error && i < PQntuples(rows) && i < HUB_PERSON_ZONES_MAX; i++) {
        w->old.ids[w->old.n++] = hub_row_id(rows, i, 0);
    }
    PQclear(rows);
    return error;
}

static int write_zones(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->row);
    int error = hub_db_run(w->store->db, "DELETE FROM directory_zone WHERE directory = $1", &values,
                           NULL, fault);
    for (size_t i = 0; !error && i < w->named->n_zones; i++) {
        struct hub_values zone = {.n = 0};
        hub_value_id(&zone, &w->row);
        hub_value_id(&zone, &w->named->zones[i]);
        error = hub_db_run(w->store->db,
                           "INSERT INTO directory_zone (directory, zone) VALUES ($1, $2)", &zone,
                           NULL, fault);
    }
    return error;
}

/* ---- the person of the fleet ---- */

static int set_link(struct work *w, const struct iso_fleet_id *person, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->row);
    hub_value_id(&values, person);
    const int error = hub_db_run(w->store->db, "UPDATE directory SET person = $2 WHERE id = $1",
                                 &values, NULL, fault);
    if (!error) {
        w->person = *person;
        w->is_linked = w->linked = true;
    }
    return error;
}

/* Somebody of this name whose request was approved since the directory named the person. */
static int find_face(struct work *w, const char *folded, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_text(&values, folded);
    hub_value_integer(&values, w->added_s);
    int error = hub_db_run(w->store->db,
                           "SELECT p.id FROM person p JOIN request r ON r.person = p.id "
                           "WHERE p.folded = $1 AND r.state = 1 AND r.time_s >= $2 AND NOT EXISTS "
                           "(SELECT 1 FROM directory d WHERE d.person = p.id)",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) == 1) {
        const struct iso_fleet_id person = hub_row_id(rows, 0, 0);
        error = set_link(w, &person, fault);
    }
    PQclear(rows);
    return error;
}

static bool is_in(const struct iso_fleet_id *ids, size_t n, const struct iso_fleet_id *id)
{
    for (size_t i = 0; i < n; i++) {
        if (iso_fleet_id_is_same(&ids[i], id)) {
            return true;
        }
    }
    return false;
}

/* What the person has from others, and what the directory gives. Somebody who is disabled or no
 * longer named gets nothing, also not from others: nobody may be let in by an old account. */
static int wanted_zones(const struct work *w, const struct hub__zones *now, struct hub__zones *out,
                        struct iso_fault *fault)
{
    out->n = 0;
    if (!w->is_named || !w->named->active) {
        return 0;
    }
    for (size_t i = 0; i < now->n; i++) {
        if (!is_in(w->old.ids, w->old.n, &now->ids[i])) {
            out->ids[out->n++] = now->ids[i];
        }
    }
    for (size_t i = 0; i < w->named->n_zones; i++) {
        if (is_in(out->ids, out->n, &w->named->zones[i])) {
            continue;
        }
        if (out->n == HUB_PERSON_ZONES_MAX) {
            return iso_fault_set(fault, -E2BIG, "%s: more than %d zones", w->named->name,
                                 HUB_PERSON_ZONES_MAX);
        }
        out->ids[out->n++] = w->named->zones[i];
    }
    return 0;
}

static bool is_same(const struct hub__zones *a, const struct hub__zones *b)
{
    bool same = a->n == b->n;
    for (size_t i = 0; same && i < a->n; i++) {
        same = is_in(b->ids, b->n, &a->ids[i]);
    }
    return same;
}

static int write_person(const struct work *w, const char *folded, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->person);
    hub_value_text(&values, w->named->name);
    hub_value_text(&values, folded);
    hub_value_integer(&values, w->named->from_s);
    hub_value_integer(&values, w->named->until_s);
    const int error = hub_db_run(w->store->db,
                                 "UPDATE person SET name = $2, folded = $3, valid_from_s = $4, "
                                 "valid_until_s = $5 WHERE id = $1",
                                 &values, NULL, fault);
    return error == -EEXIST
               ? iso_fault_set(fault, error, "%s: another person of the fleet has this name",
                               w->named->name)
               : error;
}

/* Changes the person in one revision if anything differs. */
static int bring(const struct work *w, const char *folded, struct iso_fault *fault)
{
    struct hub__zones now = {.n = 0}, wanted = {.n = 0};
    struct hub_person person;
    json_t *before = NULL;
    char id[ISO_FLEET_ID_TEXT_SIZE];
    int error = hub__person_lock(w->store, &w->person, &now, &before, fault);
    error = error ? error
                  : hub_person_find(w->store, iso_fleet_id_text(&w->person, id), &person, fault);
    error = error ? error : wanted_zones(w, &now, &wanted, fault);
    const bool same = !error && is_same(&now, &wanted) &&
                      strcmp(person.name, w->named->name) == 0 &&
                      person.valid_from_s == w->named->from_s &&
                      person.valid_until_s == w->named->until_s;
    if (error || same) {
        json_decref(before);
        return error;
    }
    error = write_person(w, folded, fault);
    error = error ? error
                  : hub__person_put_zones(w->store, &w->person, wanted.ids, wanted.n, fault);
    error = error ? error : hub__person_spread(w->store, &w->person, &now, fault);
    if (error) {
        json_decref(before);
        return error;
    }
    return hub__act_add(w->store, "person-directory", w->named->name, before,
                        hub__person_json(w->store, &w->person), fault);
}

/* ---- both ---- */

static int apply_folded(struct work *w, const char *folded, struct iso_fault *fault)
{
    int error = upsert(w, folded, fault);
    error = error ? error : read_old_zones(w, fault);
    error = error ? error : write_zones(w, fault);
    if (!error && w->link) {
        error = w->is_linked
                    ? iso_fault_set(fault, -EEXIST, "%s: is linked already", w->named->external)
                    : set_link(w, w->link, fault);
    } else if (!error && !w->is_linked && w->is_named && w->named->active) {
        error = find_face(w, folded, fault);
    }
    return error || !w->is_linked ? error : bring(w, folded, fault);
}

static int apply(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    char *folded = NULL;
    w->linked = false;
    int error = iso_name_fold(w->named->name, &folded);
    if (error) {
        return iso_fault_set(fault, error, "the name is not UTF-8");
    }
    error = apply_folded(w, folded, fault);
    free(folded);
    return error;
}

int hub__directory_apply(struct hub_store *store, const char *source, const struct hub_named *named,
                         bool is_named, bool *linked, struct iso_fault *fault)
{
    struct work w = {.store = store, .source = source, .named = named, .is_named = is_named};
    const int error = hub_db_transaction(store->db, HUB_READ_COMMITTED, apply, &w, fault);
    if (!error) {
        *linked = w.linked;
    }
    return error;
}

int hub_directory_put(struct hub_store *store, const char *source, const struct hub_named *named,
                      struct iso_fault *fault)
{
    bool linked = false;
    return hub__directory_apply(store, source, named, true, &linked, fault);
}

/* Reads the name that is stored, without which nobody can be applied. */
static int read_name(const struct work *w, struct hub_named *named, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_text(&values, w->source);
    hub_value_text(&values, named->external);
    int error = hub_db_run(w->store->db,
                           "SELECT name FROM directory WHERE source = $1 AND external = $2",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "%s: the directory does not name it",
                              named->external);
    } else if (!error) {
        (void)snprintf(named->name, sizeof named->name, "%s", hub_row_text(rows, 0, 0));
    }
    PQclear(rows);
    return error;
}

static int remove_one(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct hub_named named = *w->named;
    struct hub_values values = {.n = 0};
    bool linked = false;
    int error = read_name(w, &named, fault);
    error = error ? error
                  : hub__directory_apply(w->store, w->source, &named, false, &linked, fault);
    hub_value_text(&values, w->source);
    hub_value_text(&values, named.external);
    return error ? error
                 : hub_db_run(w->store->db,
                              "DELETE FROM directory WHERE source = $1 AND external = $2", &values,
                              NULL, fault);
}

int hub_directory_remove(struct hub_store *store, const char *source, const char *external,
                         struct iso_fault *fault)
{
    struct hub_named named = {.active = false};
    struct work w = {.store = store, .source = source, .named = &named};
    (void)snprintf(named.external, sizeof named.external, "%s", external);
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, remove_one, &w, fault);
}

int hub_directory_link(struct hub_store *store, const char *source, const char *external,
                       const struct iso_fleet_id *person, struct iso_fault *fault)
{
    struct hub__listed *list = NULL;
    size_t n = 0, i = 0;
    int error = hub__directory_load(store, source, HUB__LISTED_ALL, &list, &n, fault);
    if (error) {
        return error;
    }
    while (i < n && strcmp(list[i].named.external, external) != 0) {
        i++;
    }
    if (i == n) {
        error = iso_fault_set(fault, -ENOENT, "%s: the directory does not name it", external);
    } else {
        struct work w = {.store = store,
                         .source = source,
                         .named = &list[i].named,
                         .is_named = list[i].is_named,
                         .link = person};
        error = hub_db_transaction(store->db, HUB_READ_COMMITTED, apply, &w, fault);
    }
    free(list);
    return error;
}
