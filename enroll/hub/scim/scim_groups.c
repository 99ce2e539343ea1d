#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/scim/scim_rows.h"
#include "enroll/hub/store/hub_act.h"

#define COLUMNS "g.id, g.version, g.made_s, g.changed_s, g.display, g.external, "
#define MEMBERS                                                                        \
    "coalesce((SELECT json_agg(json_build_object('value', m.member::text, 'display', " \
    "u.user_name) ORDER BY u.user_name)::text FROM scim_member m JOIN scim_user u "    \
    "ON u.id = m.member WHERE m.team = g.id), '[]')"

static void take(const PGresult *rows, int i, struct scim_group *group, struct scim_row *row)
{
    *row = (struct scim_row){.id = hub_row_id(rows, i, 0),
                             .version = hub_row_integer(rows, i, 1),
                             .made_s = hub_row_integer(rows, i, 2),
                             .changed_s = hub_row_integer(rows, i, 3),
                             .related = hub_row_text(rows, i, 6)};
    *group = (struct scim_group){.display = ""};
    (void)snprintf(group->display, sizeof group->display, "%s", hub_row_text(rows, i, 4));
    (void)snprintf(group->external, sizeof group->external, "%s", hub_row_text(rows, i, 5));
}

static int read_members(struct hub_store *store, const struct iso_fleet_id *id,
                        struct scim_ids *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_id(&values, id);
    int error = hub_db_run(store->db, "SELECT member FROM scim_member WHERE team = $1", &values,
                           &rows, fault);
    *out = (struct scim_ids){.n = 0};
    if (!error) {
        out->ids = calloc((size_t)PQntuples(rows) + 1, sizeof *out->ids);
        error = out->ids ? 0 : iso_fault_set(fault, -ENOMEM, "a group: no memory");
    }
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        out->ids[out->n++] = hub_row_id(rows, i, 0);
    }
    scim_ids_order(out);
    PQclear(rows);
    return error;
}

int hub__scim_group_load(struct hub_store *store, const struct iso_fleet_id *id,
                         struct scim_group *group, struct scim_row *row, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    struct scim_group loaded;
    PGresult *rows = NULL;

    hub_value_id(&values, id);
    int error = hub_db_run(store->db, "SELECT " COLUMNS "'' FROM scim_group g WHERE g.id = $1",
                           &values, &rows, fault);
    if (!error && PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "there is no such group");
    } else if (!error) {
        take(rows, 0, &loaded, row);
        row->related = "[]";
        error = read_members(store, id, &loaded.members, fault);
    }
    PQclear(rows);
    if (!error) {
        *group = loaded;
    }
    return error;
}

/* ---- changes ---- */

static int write_row(struct hub_store *store, const struct iso_fleet_id *id,
                     const struct scim_group *group, bool is_new, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    char *folded = NULL;
    int error = hub__scim_fold(group->display, &folded, fault);

    if (error) {
        return error;
    }
    hub_value_id(&values, id);
    hub_value_text(&values, group->display);
    hub_value_text(&values, folded);
    hub_value_text(&values, group->external);
    hub_value_integer(&values, store->now_s());
    error = hub_db_run(store->db,
                       is_new ? "INSERT INTO scim_group (id, display, folded, external, made_s, "
                                "changed_s) VALUES ($1, $2, $3, $4, $5, $5)"
                              : "UPDATE scim_group SET display = $2, folded = $3, external = $4, "
                                "changed_s = $5, version = version + 1 WHERE id = $1",
                       &values, NULL, fault);
    free(folded);
    return error == -EEXIST
               ? iso_fault_set(fault, error, "another group has the name %.80s", group->display)
               : error;
}

static int write_member(struct hub_store *store, const struct iso_fleet_id *group,
                        const struct iso_fleet_id *member, bool is_in, struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    struct hub_values values = {.n = 0};

    hub_value_id(&values, group);
    hub_value_id(&values, member);
    const int error = hub_db_run(store->db,
                                 is_in ? "INSERT INTO scim_member (team, member) VALUES ($1, $2)"
                                       : "DELETE FROM scim_member WHERE team = $1 AND member = $2",
                                 &values, NULL, fault);
    return error == -ENOENT ? iso_fault_set(fault, -EINVAL, "there is no user %s",
                                            iso_fleet_id_text(member, text))
                            : error;
}

static int spread_all(struct hub_store *store, const struct scim_ids *ids, struct iso_fault *fault)
{
    int error = 0;

    for (size_t i = 0; !error && i < ids->n; i++) {
        error = hub__scim_user_spread(store, &ids->ids[i], true, fault);
    }
    return error;
}

/* Stores who comes and who goes, and brings these to their zones. */
static int write_members(struct hub_store *store, const struct iso_fleet_id *id,
                         const struct scim_ids *now, const struct scim_ids *before, bool all,
                         struct iso_fault *fault)
{
    struct scim_ids come = {.n = 0}, go = {.n = 0};
    int error = scim_ids_without(now, before, &come);

    error = error ? error : scim_ids_without(before, now, &go);
    if (error) {
        error = iso_fault_set(fault, error, "a group: no memory");
    }
    for (size_t i = 0; !error && i < come.n; i++) {
        error = write_member(store, id, &come.ids[i], true, fault);
    }
    for (size_t i = 0; !error && i < go.n; i++) {
        error = write_member(store, id, &go.ids[i], false, fault);
    }
    error = error ? error : spread_all(store, &go, fault);
    error = error ? error : spread_all(store, all ? now : &come, fault);
    scim_ids_free(&come);
    scim_ids_free(&go);
    return error;
}

/* A group as the acts describe it. */
static json_t *json_of(const struct scim_group *group)
{
    return json_pack("{s:s, s:I}", "displayName", group->display, "members",
                     (json_int_t)group->members.n);
}

int hub__scim_group_store(struct hub_store *store, const struct iso_fleet_id *id,
                          const struct scim_group *group, const struct scim_group *before,
                          struct iso_fault *fault)
{
    const struct scim_ids none = {.n = 0};
    const bool renamed = before && strcmp(before->display, group->display) != 0;
    int error = write_row(store, id, group, !before, fault);

    error = error ? error
                  : write_members(store, id, &group->members, before ? &before->members : &none,
                                  renamed, fault);
    return error ? error
                 : hub__act_add(store, before ? "scim-group-change" : "scim-group-add",
                                group->display, before ? json_of(before) : NULL, json_of(group),
                                fault);
}

int hub__scim_group_delete(struct hub_store *store, const struct iso_fleet_id *id,
                           struct iso_fault *fault)
{
    const struct scim_ids none = {.n = 0};
    struct scim_group group = {.display = ""};
    struct scim_row row;
    struct hub_values values = {.n = 0};
    int error = hub__scim_group_load(store, id, &group, &row, fault);

    hub_value_id(&values, id);
    error = error ? error : write_members(store, id, &none, &group.members, false, fault);
    error = error ? error
                  : hub_db_run(store->db, "DELETE FROM scim_group WHERE id = $1", &values, NULL,
                               fault);
    error = error ? error
                  : hub__act_add(store, "scim-group-remove", group.display, json_of(&group), NULL,
                                 fault);
    scim_ids_free(&group.members);
    return error;
}

/* ---- lists ---- */

/* The values $1 to $4 of a filter. */
static int filter_values(const struct scim_filter *filter, char **folded,
                         struct iso_fleet_id ids[2], bool *none, struct hub_values *values,
                         struct iso_fault *fault)
{
    static const char *const names[] = {"displayname", "externalid",    "id",
                                        "members",     "members.value", NULL};
    const char *display = hub__scim_term(filter, "displayname");
    const char *id = hub__scim_term(filter, "id"), *member = hub__scim_term(filter, "members");
    int error = hub__scim_check_terms(filter, names, fault);

    member = member ? member : hub__scim_term(filter, "members.value");
    *none = (id && iso_fleet_id_read(id, &ids[0])) ||
            (member && iso_fleet_id_read(member, &ids[1]));
    error = error || !display ? error : hub__scim_fold(display, folded, fault);
    hub_value_text(values, *folded);
    hub_value_text(values, hub__scim_term(filter, "externalid"));
    hub_value_id(values, id && !*none ? &ids[0] : NULL);
    hub_value_id(values, member && !*none ? &ids[1] : NULL);
    return error;
}

#define WHERE                                                                               \
    "FROM scim_group g WHERE ($1::text IS NULL OR g.folded = $1) AND ($2::text IS NULL OR " \
    "g.external = $2) AND ($3::uuid IS NULL OR g.id = $3) AND ($4::uuid IS NULL OR EXISTS " \
    "(SELECT 1 FROM scim_member m WHERE m.team = g.id AND m.member = $4)) "

int hub__scim_groups_each(struct hub_store *store, const struct scim_page *page, int64_t *total,
                          int (*each)(void *context, const struct scim_group *group,
                                      const struct scim_row *row),
                          void *context, struct iso_fault *fault)
{
    static const struct scim_page_query query = {
        .count = "SELECT count(*) " WHERE,
        .select = "SELECT " COLUMNS "CASE WHEN $7 THEN " MEMBERS " ELSE '[]' END " WHERE
                  "ORDER BY g.made_s, g.id OFFSET $5 LIMIT $6",
    };
    char *folded = NULL;
    struct iso_fleet_id ids[2];
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    bool none = false;
    int error = filter_values(&page->filter, &folded, ids, &none, &values, fault);

    *total = 0;
    if (!error && !none) {
        error = hub__scim_page_rows(store, page, &query, &values, total, &rows, fault);
    }
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct scim_group group;
        struct scim_row row;
        take(rows, i, &group, &row);
        error = each(context, &group, &row);
    }
    PQclear(rows);
    free(folded);
    return error;
}
