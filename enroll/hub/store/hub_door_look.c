/* Reading doors. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/store/hub_door.h"

#define COLUMNS                                                                             \
    "SELECT d.id, d.name, d.joined_s, d.expelled_s, d.code_until_s, d.signs, d.receives, "  \
    "d.online, d.reported_s, d.door_time_s, d.algorithm, d.last_event, d.acked, d.health, " \
    "z.id, z.name FROM door d LEFT JOIN door_zone dz ON dz.door = d.id "                    \
    "LEFT JOIN zone z ON z.id = dz.zone "

enum { ZONE_COLUMN = 14, ZONE_NAME_COLUMN = 15 };

/* Takes a door from its first row. */
static void take_door(const PGresult *rows, int row, struct hub_door *out)
{
    *out = (struct hub_door){.id = hub_row_id(rows, row, 0),
                             .joined_s = hub_row_integer(rows, row, 2),
                             .expelled_s = hub_row_integer(rows, row, 3),
                             .code_until_s = hub_row_integer(rows, row, 4),
                             .online = hub_row_switch(rows, row, 7),
                             .reported_s = hub_row_integer(rows, row, 8),
                             .door_time_s = hub_row_integer(rows, row, 9),
                             .algorithm = (uint32_t)hub_row_integer(rows, row, 10),
                             .last_event = (uint64_t)hub_row_integer(rows, row, 11),
                             .acked = (uint64_t)hub_row_integer(rows, row, 12)};
    (void)snprintf(out->name, sizeof out->name, "%s", hub_row_text(rows, row, 1));
    (void)snprintf(out->health, sizeof out->health, "%s", hub_row_text(rows, row, 13));
    /* A door that has not joined has no keys. */
    (void)!hub_row_copy(rows, row, 5, out->signs, sizeof out->signs);
    (void)!hub_row_copy(rows, row, 6, out->receives, sizeof out->receives);
}

/* Takes a door from all its rows, one for each zone, and returns the row behind them. */
static int take_rows(const PGresult *rows, int row, struct hub_door *out)
{
    take_door(rows, row, out);
    for (; row < PQntuples(rows); row++) {
        const struct iso_fleet_id id = hub_row_id(rows, row, 0);
        if (!iso_fleet_id_is_same(&id, &out->id)) {
            break;
        }
        if (!PQgetisnull(rows, row, ZONE_COLUMN) && out->n_zones < ISO_FLEET_ZONES_MAX) {
            out->zones[out->n_zones] = hub_row_id(rows, row, ZONE_COLUMN);
            (void)snprintf(out->zone_names[out->n_zones++], HUB_NAME_SIZE, "%s",
                           hub_row_text(rows, row, ZONE_NAME_COLUMN));
        }
    }
    return row;
}

/* Takes the door of an answer. `what` names it in the fault. */
static int take_found(PGresult *rows, const char *what, struct hub_door *out,
                      struct iso_fault *fault)
{
    int error = 0;
    if (PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "%s: there is no such door", what);
    } else {
        (void)take_rows(rows, 0, out);
    }
    PQclear(rows);
    return error;
}

int hub_door_get(struct hub_store *store, const struct iso_fleet_id *door, struct hub_door *out,
                 struct iso_fault *fault)
{
    static const char sql[] = COLUMNS "WHERE d.id = $1 ORDER BY dz.position";
    struct hub_values values = {.n = 0};
    char text[ISO_FLEET_ID_TEXT_SIZE];
    PGresult *rows = NULL;
    hub_value_id(&values, door);
    const int error = hub_db_run_often(store->db, sql, &values, &rows, fault);
    return error ? error : take_found(rows, iso_fleet_id_text(door, text), out, fault);
}

int hub_door_find(struct hub_store *store, const char *name_or_id, struct hub_door *out,
                  struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    struct iso_fleet_id id;
    PGresult *rows = NULL;
    if (iso_fleet_id_read(name_or_id, &id) == 0) {
        return hub_door_get(store, &id, out, fault);
    }
    hub_value_text(&values, name_or_id);
    const int error = hub_db_run(store->db,
                                 COLUMNS
                                 "WHERE d.name = $1 "
                                 "ORDER BY d.expelled_s > 0, d.expelled_s DESC, d.id, dz.position",
                                 &values, &rows, fault);
    return error ? error : take_found(rows, name_or_id, out, fault);
}

int hub_door_each(struct hub_store *store, bool with_expelled,
                  int (*each)(void *context, const struct hub_door *door), void *context,
                  struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_switch(&values, with_expelled);
    int error = hub_db_run(
        store->db, COLUMNS "WHERE $1 OR d.expelled_s = 0 ORDER BY d.name, d.id, dz.position",
        &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows);) {
        struct hub_door door;
        i = take_rows(rows, i, &door);
        error = each(context, &door);
    }
    PQclear(rows);
    return error;
}
