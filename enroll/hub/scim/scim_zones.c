/* Which zones the members of groups get. */
#include <stdlib.h>

#include "enroll/hub/scim/scim_rows.h"
#include "enroll/hub/store/hub_act.h"

struct work {
    struct hub_store *store;
    const char *group, *folded;
    const struct iso_fleet_id *zones;
    size_t n;
};

static int write_zones(const struct work *w, struct iso_fault *fault)
{
    struct hub_values group = {.n = 0};

    hub_value_text(&group, w->folded);
    int error = hub_db_run(w->store->db, "DELETE FROM scim_zone WHERE folded = $1", &group, NULL,
                           fault);
    for (size_t i = 0; !error && i < w->n; i++) {
        struct hub_values values = {.n = 0};
        hub_value_text(&values, w->folded);
        hub_value_text(&values, w->group);
        hub_value_id(&values, &w->zones[i]);
        error = hub_db_run(w->store->db,
                           "INSERT INTO scim_zone (folded, display, zone) VALUES ($1, $2, $3) "
                           "ON CONFLICT DO NOTHING",
                           &values, NULL, fault);
    }
    return error;
}

static int spread_members(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_text(&values, w->folded);
    int error = hub_db_run(w->store->db,
                           "SELECT m.member FROM scim_member m JOIN scim_group g ON g.id = m.team "
                           "WHERE g.folded = $1",
                           &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct iso_fleet_id id = hub_row_id(rows, i, 0);
        error = hub__scim_user_spread(w->store, &id, false, fault);
    }
    PQclear(rows);
    return error;
}

/* The names of the zones of a group, for the act. */
static int names_of(const struct work *w, json_t **out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    json_t *names = json_array();

    hub_value_text(&values, w->folded);
    const int error = hub_db_run(w->store->db,
                                 "SELECT z.name FROM scim_zone s JOIN zone z ON z.id = s.zone "
                                 "WHERE s.folded = $1 ORDER BY z.name",
                                 &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        (void)json_array_append_new(names, json_string(hub_row_text(rows, i, 0)));
    }
    PQclear(rows);
    *out = names;
    return error;
}

static int set(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    json_t *before = NULL, *after = NULL;
    int error = hub__scim_lock(w->store, fault);

    error = error ? error : names_of(w, &before, fault);
    error = error ? error : write_zones(w, fault);
    error = error ? error : spread_members(w, fault);
    error = error ? error : names_of(w, &after, fault);
    if (error) {
        json_decref(before);
        json_decref(after);
        return error;
    }
    return hub__act_add(w->store, "scim-zones", w->group, before, after, fault);
}

int hub_scim_zones_set(struct hub_store *store, const char *group, const struct iso_fleet_id *zones,
                       size_t n, struct iso_fault *fault)
{
    char *folded = NULL;
    int error = hub__scim_fold(group, &folded, fault);
    struct work w = {.store = store, .group = group, .folded = folded, .zones = zones, .n = n};

    error = error ? error : hub_db_transaction(store->db, HUB_READ_COMMITTED, set, &w, fault);
    free(folded);
    return error;
}

int hub_scim_zones_each(struct hub_store *store,
                        int (*each)(void *context, const struct hub_scim_group_zone *entry),
                        void *context, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(store->db,
                           "SELECT coalesce(g.display, s.display), coalesce(z.name, ''), "
                           "g.id IS NOT NULL, (SELECT count(*) FROM scim_member m "
                           "WHERE m.team = g.id) FROM scim_group g FULL JOIN scim_zone s "
                           "ON s.folded = g.folded LEFT JOIN zone z ON z.id = s.zone ORDER BY 1, 2",
                           NULL, &rows, fault);

    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct hub_scim_group_zone entry = {.group = hub_row_text(rows, i, 0),
                                                  .zone = hub_row_text(rows, i, 1),
                                                  .exists = hub_row_switch(rows, i, 2),
                                                  .members = hub_row_integer(rows, i, 3)};
        error = each(context, &entry);
    }
    PQclear(rows);
    return error;
}
