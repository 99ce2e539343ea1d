#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "enroll/hub/directory/hub_directory.h"
#include "enroll/hub/scim/scim_rows.h"
#include "enroll/hub/store/hub_act.h"

#define COLUMNS                                                                                 \
    "u.id, u.version, u.made_s, u.changed_s, u.user_name, u.external, u.display, u.formatted, " \
    "u.given, u.family, u.active, u.valid_from_s, u.valid_until_s, "
#define GROUPS                                                                                \
    "coalesce((SELECT json_agg(json_build_object('value', g.id::text, 'display', g.display) " \
    "ORDER BY g.display)::text FROM scim_member m JOIN scim_group g ON g.id = m.team "        \
    "WHERE m.member = u.id), '[]')"

static void take(const PGresult *rows, int i, struct scim_user *user, struct scim_row *row)
{
    char *const texts[] = {user->user_name, user->external, user->display,
                           user->formatted, user->given,    user->family};
    *row = (struct scim_row){.id = hub_row_id(rows, i, 0),
                             .version = hub_row_integer(rows, i, 1),
                             .made_s = hub_row_integer(rows, i, 2),
                             .changed_s = hub_row_integer(rows, i, 3),
                             .related = hub_row_text(rows, i, 13)};
    for (int k = 0; k < 6; k++) {
        (void)snprintf(texts[k], SCIM_TEXT_SIZE, "%s", hub_row_text(rows, i, 4 + k));
    }
    user->active = hub_row_switch(rows, i, 10);
    user->from_s = hub_row_integer(rows, i, 11);
    user->until_s = hub_row_integer(rows, i, 12);
}

int hub__scim_user_load(struct hub_store *store, const struct iso_fleet_id *id,
                        struct scim_user *user, struct scim_row *row, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_id(&values, id);
    int error = hub_db_run(store->db,
                           "SELECT " COLUMNS "'' FROM scim_user u WHERE u.id = $1 FOR UPDATE",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "there is no such user");
    } else if (!error) {
        take(rows, 0, user, row);
        row->related = "[]";
    }
    PQclear(rows);
    return error;
}

/* ---- the person ---- */

/* The zones that the groups of a user give. */
static int read_zones(struct hub_store *store, const struct iso_fleet_id *id, struct hub_named *out,
                      struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_id(&values, id);
    int error = hub_db_run(store->db,
                           "SELECT DISTINCT z.zone FROM scim_member m JOIN scim_group g "
                           "ON g.id = m.team JOIN scim_zone z ON z.folded = g.folded "
                           "WHERE m.member = $1",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) > HUB_PERSON_ZONES_MAX) {
        error = iso_fault_set(fault, -E2BIG, "%s: more than %d zones", out->name,
                              HUB_PERSON_ZONES_MAX);
    }
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        out->zones[out->n_zones++] = hub_row_id(rows, i, 0);
    }
    PQclear(rows);
    return error;
}

/* The name that the directory has, or the id: somebody who is disabled must not keep the zones
 * because of a new name that cannot be stored. */
static int read_old_name(struct hub_store *store, struct hub_named *named, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_text(&values, named->external);
    const int error = hub_db_run(store->db,
                                 "SELECT name FROM directory WHERE source = '" HUB_SCIM_SOURCE
                                 "' AND external = $1",
                                 &values, &rows, fault);
    if (!error) {
        (void)snprintf(named->name, sizeof named->name, "%s",
                       PQntuples(rows) > 0 ? hub_row_text(rows, 0, 0) : named->external);
    }
    PQclear(rows);
    return error;
}

static int name_of(struct hub_store *store, const struct iso_fleet_id *id, struct hub_named *named,
                   struct iso_fault *fault)
{
    char name[SCIM_TEXT_SIZE];
    struct scim_user user = {.active = false};
    struct scim_row row;
    int error = hub__scim_user_load(store, id, &user, &row, fault);

    (void)iso_fleet_id_text(id, named->external);
    named->active = user.active;
    named->from_s = user.from_s;
    named->until_s = user.until_s;
    if (error || !user.active) {
        return error ? error : read_old_name(store, named, fault);
    }
    error = scim_user_name(&user, name, fault);
    (void)snprintf(named->name, sizeof named->name, "%s", error ? "" : name);
    return error;
}

int hub__scim_user_spread(struct hub_store *store, const struct iso_fleet_id *id, bool counts,
                          struct iso_fault *fault)
{
    struct hub_named named = {.active = false};
    bool before = false, after = false;
    int error = hub__scim_may_enter(store, id, &before, fault);

    error = error ? error : name_of(store, id, &named, fault);
    error = error || !named.active ? error : read_zones(store, id, &named, fault);
    error = error ? error : hub_directory_put(store, HUB_SCIM_SOURCE, &named, fault);
    error = error ? error : hub__scim_may_enter(store, id, &after, fault);
    return error || !counts || !before || after ? error : hub__scim_lost(store, id, fault);
}

/* ---- changes ---- */

static int write_row(struct hub_store *store, const struct iso_fleet_id *id,
                     const struct scim_user *user, bool is_new, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    char *folded = NULL;
    int error = hub__scim_fold(user->user_name, &folded, fault);

    if (error) {
        return error;
    }
    hub_value_id(&values, id);
    hub_value_text(&values, user->user_name);
    hub_value_text(&values, folded);
    hub_value_text(&values, user->external);
    hub_value_text(&values, user->display);
    hub_value_text(&values, user->formatted);
    hub_value_text(&values, user->given);
    hub_value_text(&values, user->family);
    hub_value_switch(&values, user->active);
    hub_value_integer(&values, user->from_s);
    hub_value_integer(&values, user->until_s);
    hub_value_integer(&values, store->now_s());
    error = hub_db_run(
        store->db,
        is_new ? "INSERT INTO scim_user (id, user_name, folded, external, display, formatted, "
                 "given, family, active, valid_from_s, valid_until_s, made_s, changed_s) "
                 "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $12)"
               : "UPDATE scim_user SET user_name = $2, folded = $3, external = $4, display = $5, "
                 "formatted = $6, given = $7, family = $8, active = $9, valid_from_s = $10, "
                 "valid_until_s = $11, changed_s = $12, version = version + 1 WHERE id = $1",
        &values, NULL, fault);
    free(folded);
    return error == -EEXIST
               ? iso_fault_set(fault, error, "another user has the userName %.80s", user->user_name)
               : error;
}

int hub__scim_user_store(struct hub_store *store, const struct iso_fleet_id *id,
                         const struct scim_user *user, bool is_new, struct iso_fault *fault)
{
    struct scim_user old = {.active = false};
    struct scim_row row;
    int error = is_new ? 0 : hub__scim_user_load(store, id, &old, &row, fault);

    error = error ? error : write_row(store, id, user, is_new, fault);
    error = error ? error : hub__scim_user_spread(store, id, true, fault);
    return error
               ? error
               : hub__act_add(store, is_new ? "scim-user-add" : "scim-user-change", user->user_name,
                              is_new ? NULL : scim_user_json(&old), scim_user_json(user), fault);
}

int hub__scim_user_delete(struct hub_store *store, const struct iso_fleet_id *id,
                          struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    struct scim_user old;
    struct scim_row row;
    struct hub_values values = {.n = 0};
    bool before = false;
    int error = hub__scim_user_load(store, id, &old, &row, fault);

    hub_value_id(&values, id);
    error = error ? error : hub__scim_may_enter(store, id, &before, fault);
    error = error || !before ? error : hub__scim_lost(store, id, fault);
    error = error
                ? error
                : hub_directory_remove(store, HUB_SCIM_SOURCE, iso_fleet_id_text(id, text), fault);
    error = error ? error
                  : hub_db_run(store->db, "DELETE FROM scim_user WHERE id = $1", &values, NULL,
                               fault);
    return error ? error
                 : hub__act_add(store, "scim-user-remove", old.user_name, scim_user_json(&old),
                                NULL, fault);
}

/* ---- lists ---- */

/* The values $1 to $5 of a filter. *none: nobody can fulfil it. */
static int filter_values(const struct scim_filter *filter, char **folded, struct iso_fleet_id *id,
                         bool *none, struct hub_values *values, struct iso_fault *fault)
{
    static const char *const names[] = {"username",    "externalid", "id",
                                        "displayname", "active",     NULL};
    const char *user_name = hub__scim_term(filter, "username");
    const char *id_text = hub__scim_term(filter, "id");
    const char *active = hub__scim_term(filter, "active");
    int error = hub__scim_check_terms(filter, names, fault);

    *none = id_text && iso_fleet_id_read(id_text, id) != 0;
    error = error || !user_name ? error : hub__scim_fold(user_name, folded, fault);
    hub_value_text(values, *folded);
    hub_value_text(values, hub__scim_term(filter, "externalid"));
    hub_value_id(values, id_text && !*none ? id : NULL);
    hub_value_text(values, hub__scim_term(filter, "displayname"));
    hub_value_text(values, active ? strcasecmp(active, "true") == 0 ? "true" : "false" : NULL);
    return error;
}

#define WHERE                                                                              \
    "FROM scim_user u WHERE ($1::text IS NULL OR u.folded = $1) AND ($2::text IS NULL OR " \
    "u.external = $2) AND ($3::uuid IS NULL OR u.id = $3) AND ($4::text IS NULL OR "       \
    "u.display = $4) AND ($5::text IS NULL OR u.active = $5::boolean) "

int hub__scim_users_each(struct hub_store *store, const struct scim_page *page, int64_t *total,
                         int (*each)(void *context, const struct scim_user *user,
                                     const struct scim_row *row),
                         void *context, struct iso_fault *fault)
{
    static const struct scim_page_query query = {
        .count = "SELECT count(*) " WHERE,
        .select = "SELECT " COLUMNS "CASE WHEN $8 THEN " GROUPS " ELSE '[]' END " WHERE
                  "ORDER BY u.made_s, u.id OFFSET $6 LIMIT $7",
    };
    char *folded = NULL;
    struct iso_fleet_id id;
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    bool none = false;
    int error = filter_values(&page->filter, &folded, &id, &none, &values, fault);

    *total = 0;
    if (!error && !none) {
        error = hub__scim_page_rows(store, page, &query, &values, total, &rows, fault);
    }
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct scim_user user;
        struct scim_row row;
        take(rows, i, &user, &row);
        error = each(context, &user, &row);
    }
    PQclear(rows);
    free(folded);
    return error;
}
