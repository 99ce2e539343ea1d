#include "enroll/hub/people/hub_person_rows.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/contract/name_folding.h"

static const char credential_use[] = "credential", template_use[] = "template";

enum { CREDENTIAL = 7, ALGORITHM, SEALED };

void hub__person_free(struct hub__person *person)
{
    iso_fleet_bytes_free(&person->credential);
    for (size_t i = 0; i < person->person.n; i++) {
        iso_fleet_bytes_free(&person->templates[i]);
    }
    *person = (struct hub__person){.person.n = 0};
}

static int open_field(struct hub_store *store, const struct hub__person *person, const char *use,
                      const PGresult *rows, int row, int column, struct iso_fleet_bytes *out,
                      struct iso_fault *fault)
{
    size_t size = 0;
    const uint8_t *sealed = hub_row_bytes(rows, row, column, &size);
    const int error = hub_keys_open(&store->keys, use, &person->person.id, sealed, size, out);
    if (error == -ENOMEM) {
        return iso_fault_set(fault, error, "%s: no memory", person->name);
    }
    return error ? iso_fault_set(fault, -EBADMSG,
                                 "%s: the %s cannot be opened: it is damaged, or the key file "
                                 "belongs to another database",
                                 person->name, use)
                 : 0;
}

static int take_template(struct hub_store *store, const PGresult *rows, int row,
                         struct hub__person *out, struct iso_fault *fault)
{
    struct iso_fleet_person *person = &out->person;
    if (person->n == ISO_FLEET_TEMPLATES_MAX) {
        return iso_fault_set(fault, -E2BIG, "%s: more than %d templates", out->name,
                             ISO_FLEET_TEMPLATES_MAX);
    }
    struct iso_fleet_bytes *bytes = &out->templates[person->n];
    const int error = open_field(store, out, template_use, rows, row, SEALED, bytes, fault);
    if (!error) {
        person->templates[person->n++] = (struct iso_fleet_template){
            .algorithm = (uint32_t)hub_row_integer(rows, row, ALGORITHM),
            .size = (uint32_t)bytes->size,
            .bytes = bytes->bytes};
    }
    return error;
}

static int take_first(struct hub_store *store, const PGresult *rows, int row,
                      struct hub__person *out, struct iso_fault *fault)
{
    struct iso_fleet_person *person = &out->person;
    *out = (struct hub__person){.person = {.id = hub_row_id(rows, row, 0),
                                           .revision = (uint64_t)hub_row_integer(rows, row, 1),
                                           .valid_from_s = hub_row_integer(rows, row, 3),
                                           .valid_until_s = hub_row_integer(rows, row, 4),
                                           .enrolled_s = hub_row_integer(rows, row, 5),
                                           .offline_ok = hub_row_switch(rows, row, 6),
                                           .credential = ""}};
    (void)snprintf(out->name, sizeof out->name, "%s", hub_row_text(rows, row, 2));
    person->name = out->name;
    person->name_length = strlen(out->name);
    if (PQgetisnull(rows, row, CREDENTIAL)) {
        return 0;
    }
    const int error = open_field(store, out, credential_use, rows, row, CREDENTIAL,
                                 &out->credential, fault);
    person->credential = error ? "" : (const char *)out->credential.bytes;
    person->credential_length = out->credential.size;
    return error;
}

int hub__person_take(struct hub_store *store, const PGresult *rows, int *row,
                     struct hub__person *out, struct iso_fault *fault)
{
    int at = *row;
    int error = take_first(store, rows, at, out, fault);
    for (; !error && at < PQntuples(rows); at++) {
        const struct iso_fleet_id id = hub_row_id(rows, at, 0);
        if (!iso_fleet_id_is_same(&id, &out->person.id)) {
            break;
        }
        if (!PQgetisnull(rows, at, SEALED)) {
            error = take_template(store, rows, at, out, fault);
        }
    }
    if (error) {
        hub__person_free(out);
        return error;
    }
    *row = at;
    return 0;
}

int hub__person_load(struct hub_store *store, const struct iso_fleet_id *id,
                     struct hub__person *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    int row = 0;
    hub_value_id(&values, id);
    int error = hub_db_run(store->db,
                           "SELECT " HUB__PERSON_COLUMNS "FROM person p LEFT JOIN template t "
                           "ON t.person = p.id WHERE p.id = $1 ORDER BY t.number",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    error = PQntuples(rows) == 0 ? iso_fault_set(fault, -ENOENT, "there is no such person")
                                 : hub__person_take(store, rows, &row, out, fault);
    PQclear(rows);
    return error;
}

int hub__person_name_taken(const char *name, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EEXIST, "%s: another person of the fleet has this name", name);
}

int hub__credential_seal(struct hub_store *store, const struct iso_fleet_id *person,
                         const char *json, size_t length, struct iso_fleet_bytes *sealed,
                         struct iso_fault *fault)
{
    const int error = length == 0 ? 0
                                  : hub_keys_seal(&store->keys, credential_use, person, json,
                                                  length, sealed);
    return error ? iso_fault_set(fault, error, "credential: no memory") : 0;
}

/* The templates of an algorithm are replaced together; those of other algorithms stay. */
static int store_templates(struct hub_store *store, const struct iso_fleet_person *person,
                           struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < person->n; i++) {
        struct hub_values values = {.n = 0};
        hub_value_id(&values, &person->id);
        hub_value_integer(&values, person->templates[i].algorithm);
        error = hub_db_run(store->db, "DELETE FROM template WHERE person = $1 AND algorithm = $2",
                           &values, NULL, fault);
    }
    for (size_t i = 0; !error && i < person->n; i++) {
        const struct iso_fleet_template *t = &person->templates[i];
        struct iso_fleet_bytes sealed = {.bytes = NULL};
        struct hub_values values = {.n = 0};
        error = hub_keys_seal(&store->keys, template_use, &person->id, t->bytes, t->size, &sealed);
        hub_value_id(&values, &person->id);
        hub_value_integer(&values, t->algorithm);
        hub_value_bytes(&values, sealed.bytes, sealed.size);
        error = error ? iso_fault_set(fault, error, "template: no memory")
                      : hub_db_run(store->db,
                                   "INSERT INTO template (person, number, algorithm, sealed) "
                                   "SELECT $1, coalesce(max(number), 0) + 1, $2, $3 FROM template "
                                   "WHERE person = $1",
                                   &values, NULL, fault);
        iso_fleet_bytes_free(&sealed);
    }
    return error;
}

/* A person who is seen by a third algorithm has too many templates: those go that no door uses. */
static int drop_unused(struct hub_store *store, const struct iso_fleet_person *person,
                       struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    if (person->n == 0) {
        return 0;
    }
    hub_value_id(&values, &person->id);
    hub_value_integer(&values, person->templates[0].algorithm);
    hub_value_integer(&values, ISO_FLEET_TEMPLATES_MAX);
    return hub_db_run(store->db,
                      "DELETE FROM template t WHERE t.person = $1 AND t.algorithm <> $2 "
                      "AND (SELECT count(*) FROM template WHERE person = $1) > $3 "
                      "AND NOT EXISTS (SELECT 1 FROM door d WHERE d.algorithm = t.algorithm "
                      "AND d.joined_s > 0 AND d.expelled_s = 0)",
                      &values, NULL, fault);
}

static int upsert(struct hub_store *store, const struct iso_fleet_person *person, const char *name,
                  const char *folded, bool *is_new, struct iso_fault *fault)
{
    struct iso_fleet_bytes credential = {.bytes = NULL};
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    int error = hub__credential_seal(store, &person->id, person->credential,
                                     person->credential_length, &credential, fault);
    if (error) {
        return error;
    }
    hub_value_id(&values, &person->id);
    hub_value_text(&values, name);
    hub_value_text(&values, folded);
    hub_value_integer(&values, person->valid_from_s);
    hub_value_integer(&values, person->valid_until_s);
    hub_value_integer(&values, person->enrolled_s);
    hub_value_switch(&values, person->offline_ok);
    hub_value_bytes(&values, credential.bytes, credential.size);
    /* xmax is 0 in a row that was inserted, not updated. */
    error = hub_db_run(store->db,
                       "INSERT INTO person (id, name, folded, revision, valid_from_s, "
                       "valid_until_s, enrolled_s, offline_ok, credential) VALUES ($1, $2, $3, 0, "
                       "$4, $5, $6, $7, $8) ON CONFLICT (id) DO UPDATE SET name = $2, folded = $3, "
                       "valid_from_s = $4, valid_until_s = $5, enrolled_s = $6, offline_ok = $7, "
                       "credential = $8 RETURNING xmax = 0",
                       &values, &rows, fault);
    iso_fleet_bytes_free(&credential);
    if (error) {
        return error == -EEXIST ? hub__person_name_taken(name, fault) : error;
    }
    *is_new = hub_row_switch(rows, 0, 0);
    PQclear(rows);
    return 0;
}

int hub__person_store(struct hub_store *store, const struct iso_fleet_person *person, bool *is_new,
                      struct iso_fault *fault)
{
    char name[ISO_FLEET_NAME_MAX + 1], *folded = NULL;
    (void)snprintf(name, sizeof name, "%.*s", (int)person->name_length, person->name);
    int error = iso_name_fold(name, &folded);
    if (error) {
        return iso_fault_set(fault, error, "%s",
                             error == -EINVAL ? "the name is not UTF-8" : "person: no memory");
    }
    error = upsert(store, person, name, folded, is_new, fault);
    error = error ? error : store_templates(store, person, fault);
    error = error ? error : drop_unused(store, person, fault);
    free(folded);
    return error;
}
