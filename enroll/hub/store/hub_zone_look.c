/* Reading zones. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/store/hub_zone.h"

#define COLUMNS                                                                       \
    "SELECT id, epoch, sequence, digest, base_sequence, base_digest, reset_epoch, "   \
    "reset_sequence, name, lease_s, local_people, approve_auto, lockdown, behind, "   \
    "published, (SELECT coalesce(max(s.sequence), 0) FROM snapshot s WHERE s.zone = " \
    "z.id)::bigint, "                                                                 \
    "(SELECT count(*) FROM person_zone p WHERE p.zone = z.id), "                      \
    "(SELECT count(*) FROM door_zone d WHERE d.zone = z.id) FROM zone z "

static int take_zone(const PGresult *rows, int row, struct hub_zone *out, struct iso_fault *fault)
{
    struct hub_zone zone = {.place.zone = hub_row_id(rows, row, 0),
                            .place.epoch = (uint64_t)hub_row_integer(rows, row, 1),
                            .place.sequence = (uint64_t)hub_row_integer(rows, row, 2),
                            .base.sequence = (uint64_t)hub_row_integer(rows, row, 4),
                            .reset_epoch = (uint64_t)hub_row_integer(rows, row, 6),
                            .reset_sequence = (uint64_t)hub_row_integer(rows, row, 7),
                            .settings.lease_s = (uint32_t)hub_row_integer(rows, row, 9),
                            .settings.local_people = hub_row_switch(rows, row, 10),
                            .settings.approve_auto = hub_row_switch(rows, row, 11),
                            .lockdown = hub_row_switch(rows, row, 12),
                            .behind = hub_row_switch(rows, row, 13),
                            .published = (uint64_t)hub_row_integer(rows, row, 14),
                            .snapshot_sequence = (uint64_t)hub_row_integer(rows, row, 15),
                            .people = (uint64_t)hub_row_integer(rows, row, 16),
                            .doors = (uint64_t)hub_row_integer(rows, row, 17)};
    zone.base.zone = zone.place.zone;
    zone.base.epoch = zone.place.epoch;
    (void)snprintf(zone.name, sizeof zone.name, "%s", hub_row_text(rows, row, 8));
    if (hub_row_copy(rows, row, 3, zone.place.digest, sizeof zone.place.digest) ||
        hub_row_copy(rows, row, 5, zone.base.digest, sizeof zone.base.digest)) {
        return iso_fault_set(fault, -EBADMSG, "zone %s: its digest is damaged", zone.name);
    }
    *out = zone;
    return 0;
}

int hub_zone_find(struct hub_store *store, const char *name_or_id, struct hub_zone *out,
                  struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    struct iso_fleet_id id = {.bytes = {0}};
    PGresult *rows = NULL;
    const bool is_id = iso_fleet_id_read(name_or_id, &id) == 0;
    hub_value_text(&values, name_or_id);
    hub_value_id(&values, is_id ? &id : NULL);
    int error = hub_db_run(store->db, COLUMNS "WHERE name = $1 OR id = $2", &values, &rows, fault);
    if (error) {
        return error;
    }
    error = PQntuples(rows) == 0
                ? iso_fault_set(fault, -ENOENT, "%s: there is no such zone", name_or_id)
                : take_zone(rows, 0, out, fault);
    PQclear(rows);
    return error;
}

int hub_zone_each(struct hub_store *store, int (*each)(void *context, const struct hub_zone *zone),
                  void *context, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(store->db, COLUMNS "ORDER BY name", NULL, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct hub_zone zone;
        error = take_zone(rows, i, &zone, fault);
        error = error ? error : each(context, &zone);
    }
    PQclear(rows);
    return error;
}

int hub_zone_get_policy(struct hub_store *store, const struct iso_fleet_id *zone, char **document,
                        struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, zone);
    int error = hub_db_run(store->db, "SELECT policy FROM zone WHERE id = $1", &values, &rows,
                           fault);
    if (error) {
        return error;
    }
    if (PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -ENOENT, "there is no such zone");
    } else {
        char *text = strdup(hub_row_text(rows, 0, 0));
        error = text ? 0 : iso_fault_set(fault, -ENOMEM, "policy: no memory");
        *document = text ? text : *document;
    }
    PQclear(rows);
    return error;
}

int hub_doors_behind(struct hub_store *store, const struct iso_fleet_id *zone,
                     int (*each)(void *context, const struct hub_behind *door), void *context,
                     struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, zone);
    int error = hub_db_run(store->db,
                           "SELECT d.id, d.name, p.epoch, p.sequence, d.reported_s, d.online "
                           "FROM zone z JOIN door_zone dz ON dz.zone = z.id "
                           "JOIN door d ON d.id = dz.door AND d.joined_s > 0 AND d.expelled_s = 0 "
                           "LEFT JOIN door_place p ON p.door = d.id AND p.zone = z.id "
                           "WHERE z.id = $1 AND (p.door IS NULL OR p.epoch <> z.epoch "
                           "OR p.sequence <> z.sequence OR p.digest <> z.digest) ORDER BY d.name",
                           &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct hub_behind door = {.door = hub_row_id(rows, i, 0),
                                        .name = hub_row_text(rows, i, 1),
                                        .epoch = (uint64_t)hub_row_integer(rows, i, 2),
                                        .sequence = (uint64_t)hub_row_integer(rows, i, 3),
                                        .reported_s = hub_row_integer(rows, i, 4),
                                        .online = hub_row_switch(rows, i, 5)};
        error = each(context, &door);
    }
    PQclear(rows);
    return error;
}
