#include "enroll/hub/directory/directory_rows.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ZONE = 10 };

/* Takes one person from all its rows, one for each zone, and returns the row behind them. */
static int take(const PGresult *rows, int row, struct hub__listed *out)
{
    struct hub_named *named = &out->named;
    *out = (struct hub__listed){.named = {.active = hub_row_switch(rows, row, 2),
                                          .from_s = hub_row_integer(rows, row, 3),
                                          .until_s = hub_row_integer(rows, row, 4)},
                                .is_named = hub_row_switch(rows, row, 5),
                                .added_s = hub_row_integer(rows, row, 6),
                                .is_linked = !PQgetisnull(rows, row, 7),
                                .person = hub_row_id(rows, row, 7),
                                .has_face = hub_row_switch(rows, row, 8),
                                .is_astray = hub_row_switch(rows, row, 9)};
    (void)snprintf(named->external, sizeof named->external, "%s", hub_row_text(rows, row, 0));
    (void)snprintf(named->name, sizeof named->name, "%s", hub_row_text(rows, row, 1));
    for (; row < PQntuples(rows) && strcmp(hub_row_text(rows, row, 0), named->external) == 0;
         row++) {
        if (!PQgetisnull(rows, row, ZONE) && named->n_zones < HUB_PERSON_ZONES_MAX) {
            named->zones[named->n_zones++] = hub_row_id(rows, row, ZONE);
        }
    }
    return row;
}

int hub__directory_load(struct hub_store *store, const char *source, enum hub__listed_which which,
                        struct hub__listed **out, size_t *n, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_text(&values, source);
    hub_value_switch(&values, which == HUB__LISTED_DUE);
    const int error = hub_db_run(
        store->db,
        "SELECT l.*, z.zone FROM (SELECT d.external, d.name, d.active, d.valid_from_s, "
        "d.valid_until_s, d.named, d.added_s, d.person, d.person IS NULL AND EXISTS (SELECT 1 "
        "FROM person p JOIN request r ON r.person = p.id WHERE p.folded = d.folded "
        "AND r.state = 1 AND r.time_s >= d.added_s) AS has_face, CASE WHEN d.person IS NULL "
        "THEN false WHEN d.active AND d.named THEN EXISTS (SELECT 1 FROM directory_zone g "
        "WHERE g.directory = d.id AND NOT EXISTS (SELECT 1 FROM person_zone h "
        "WHERE h.person = d.person AND h.zone = g.zone)) ELSE EXISTS (SELECT 1 FROM person_zone h "
        "WHERE h.person = d.person) END AS is_astray FROM directory d WHERE d.source = $1) l "
        "LEFT JOIN directory d ON d.source = $1 AND d.external = l.external "
        "LEFT JOIN directory_zone z ON z.directory = d.id "
        "WHERE NOT $2 OR (l.has_face AND l.active AND l.named) OR l.is_astray "
        "ORDER BY l.external COLLATE \"C\", z.zone",
        &values, &rows, fault);
    if (error) {
        return error;
    }
    const int n_rows = PQntuples(rows);
    struct hub__listed *list = calloc((size_t)n_rows + 1, sizeof *list);
    size_t n_listed = 0;
    for (int row = 0; list && row < n_rows;) {
        row = take(rows, row, &list[n_listed++]);
    }
    PQclear(rows);
    if (!list) {
        return iso_fault_set(fault, -ENOMEM, "the directory: no memory");
    }
    *out = list;
    *n = n_listed;
    return 0;
}

static bool has_zone(const struct hub_named *named, const struct iso_fleet_id *zone)
{
    for (size_t i = 0; i < named->n_zones; i++) {
        if (iso_fleet_id_is_same(&named->zones[i], zone)) {
            return true;
        }
    }
    return false;
}

bool hub__directory_differs(const struct hub__listed *listed, const struct hub_named *named)
{
    const struct hub_named *old = &listed->named;
    bool same = listed->is_named && strcmp(old->name, named->name) == 0 &&
                old->active == named->active && old->from_s == named->from_s &&
                old->until_s == named->until_s && old->n_zones == named->n_zones;
    for (size_t i = 0; same && i < named->n_zones; i++) {
        same = has_zone(old, &named->zones[i]);
    }
    return !same;
}
