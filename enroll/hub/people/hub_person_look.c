/* Reading people. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/people/hub_person.h"
#include "firmware/contract/name_folding.h"

#define COLUMNS                                                                        \
    "SELECT p.id, p.revision, p.name, p.valid_from_s, p.valid_until_s, p.enrolled_s, " \
    "p.offline_ok, (SELECT count(*) FROM template t WHERE t.person = p.id), z.id, z.name "

enum { ZONE_COLUMN = 8, ZONE_NAME_COLUMN = 9 };

/* Takes a person from all its rows, one for each zone, and returns the row behind them. */
static int take_rows(const PGresult *rows, int row, struct hub_person *out)
{
    *out = (struct hub_person){.id = hub_row_id(rows, row, 0),
                               .revision = (uint64_t)hub_row_integer(rows, row, 1),
                               .valid_from_s = hub_row_integer(rows, row, 3),
                               .valid_until_s = hub_row_integer(rows, row, 4),
                               .enrolled_s = hub_row_integer(rows, row, 5),
                               .offline_ok = hub_row_switch(rows, row, 6),
                               .templates = (uint32_t)hub_row_integer(rows, row, 7)};
    (void)snprintf(out->name, sizeof out->name, "%s", hub_row_text(rows, row, 2));
    for (; row < PQntuples(rows); row++) {
        const struct iso_fleet_id id = hub_row_id(rows, row, 0);
        if (!iso_fleet_id_is_same(&id, &out->id)) {
            break;
        }
        if (!PQgetisnull(rows, row, ZONE_COLUMN) && out->n_zones < HUB_PERSON_ZONES_MAX) {
            out->zones[out->n_zones] = hub_row_id(rows, row, ZONE_COLUMN);
            (void)snprintf(out->zone_names[out->n_zones++], HUB_NAME_SIZE, "%s",
                           hub_row_text(rows, row, ZONE_NAME_COLUMN));
        }
    }
    return row;
}

static int fold(const char *name, char **folded, struct iso_fault *fault)
{
    const int error = iso_name_fold(name, folded);
    return error ? iso_fault_set(fault, error, "%s",
                                 error == -EINVAL ? "the name is not UTF-8" : "name: no memory")
                 : 0;
}

int hub_person_find(struct hub_store *store, const char *name_or_id, struct hub_person *out,
                    struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    struct iso_fleet_id id;
    PGresult *rows = NULL;
    char *folded = NULL;
    int error = fold(name_or_id, &folded, fault);
    if (error) {
        return error;
    }
    hub_value_id(&values, iso_fleet_id_read(name_or_id, &id) == 0 ? &id : NULL);
    hub_value_text(&values, folded);
    error = hub_db_run(store->db,
                       COLUMNS "FROM person p LEFT JOIN person_zone pz ON pz.person = p.id "
                               "LEFT JOIN zone z ON z.id = pz.zone "
                               "WHERE p.id = $1 OR p.folded = $2 ORDER BY p.id <> $1, z.name",
                       &values, &rows, fault);
    free(folded);
    if (error) {
        return error;
    }
    if (PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "%s: there is no such person", name_or_id);
    } else {
        (void)take_rows(rows, 0, out);
    }
    PQclear(rows);
    return error;
}

/* The people of a filter in a table "p", then their zones. $1 is a part of the folded name, $2 a
 * zone, $3 whether only unseen people are wanted, $4 how many, $5 the folded name after which they
 * begin. */
static const char each_sql[] =
    "WITH used AS (SELECT DISTINCT dz.zone, d.algorithm FROM door_zone dz "
    "JOIN door d ON d.id = dz.door AND d.reported_s > 0 AND d.expelled_s = 0) " COLUMNS
    "FROM (SELECT * FROM person q WHERE position($1 in q.folded) > 0 "
    "AND ($2::uuid IS NULL OR EXISTS (SELECT 1 FROM person_zone x WHERE x.person = q.id "
    "AND x.zone = $2)) "
    "AND (NOT $3 OR EXISTS (SELECT 1 FROM person_zone x JOIN used u ON u.zone = x.zone "
    "WHERE x.person = q.id AND NOT EXISTS (SELECT 1 FROM template t WHERE t.person = q.id "
    "AND t.algorithm = u.algorithm))) "
    "AND q.folded > $5 ORDER BY q.folded LIMIT $4) p "
    "LEFT JOIN person_zone pz ON pz.person = p.id LEFT JOIN zone z ON z.id = pz.zone "
    "ORDER BY p.folded, z.name";

int hub_person_each(struct hub_store *store, const struct hub_person_filter *filter,
                    int (*each)(void *context, const struct hub_person *person), void *context,
                    struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    char *folded = NULL, *after = NULL;
    int error = fold(filter->part ? filter->part : "", &folded, fault);
    error = error ? error : fold(filter->after ? filter->after : "", &after, fault);
    if (error) {
        free(folded);
        return error;
    }
    hub_value_text(&values, folded);
    hub_value_id(&values, filter->zone);
    hub_value_switch(&values, filter->unseen);
    hub_value_integer(&values, filter->most ? (int64_t)filter->most : INT64_MAX);
    hub_value_text(&values, after);
    error = hub_db_run(store->db, each_sql, &values, &rows, fault);
    free(folded);
    free(after);
    for (int i = 0; !error && i < PQntuples(rows);) {
        struct hub_person person;
        i = take_rows(rows, i, &person);
        error = each(context, &person);
    }
    PQclear(rows);
    return error;
}
