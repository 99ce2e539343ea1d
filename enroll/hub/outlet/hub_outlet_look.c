/* Reads the rows of outlets. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/outlet/batch.h"

#define COLUMNS                                                                \
    "o.id, o.name, o.kind, o.address, o.events, o.ca IS NOT NULL, o.stopped, " \
    "o.batch IS NOT NULL, o.delivered, o.failures, o.next_attempt_ms, o.delivered_s, o.trouble "

/* What follows the columns in a statement. */
enum { NEXT_ATTEMPT = 10, FIRST_FURTHER = 13 };

#define COPY(member, column) \
    (void)snprintf(out->member, sizeof out->member, "%s", hub_row_text(rows, row, column))

static void take(const PGresult *rows, int row, struct hub_outlet *out)
{
    *out = (struct hub_outlet){
        .id = hub_row_id(rows, row, 0),
        .kind = strcmp(hub_row_text(rows, row, 2), "webhook") == 0 ? HUB_OUTLET_WEBHOOK
                                                                   : HUB_OUTLET_SYSLOG,
        .has_ca = hub_row_switch(rows, row, 5),
        .stopped = hub_row_switch(rows, row, 6),
        .in_flight = hub_row_switch(rows, row, 7),
        .delivered = (uint64_t)hub_row_integer(rows, row, 8),
        .failures = (uint64_t)hub_row_integer(rows, row, 9),
        .next_attempt_s = (hub_row_integer(rows, row, NEXT_ATTEMPT) + 999) / 1000,
        .delivered_s = hub_row_integer(rows, row, 11),
    };
    COPY(name, 1);
    COPY(address, 3);
    COPY(events, 4);
    COPY(trouble, 12);
}

int hub_outlet_each(struct hub_store *store,
                    int (*each)(void *context, const struct hub_outlet *outlet), void *context,
                    struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(store->db,
                           "SELECT " COLUMNS ", (SELECT coalesce(sum(greatest("
                           "d.acked - coalesce(c.number, 0), 0)), 0)::bigint FROM door d "
                           "LEFT JOIN outlet_cursor c ON c.outlet = o.id AND c.door = d.id) "
                           "FROM outlet o ORDER BY o.name",
                           NULL, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct hub_outlet outlet;
        take(rows, i, &outlet);
        outlet.waiting = (uint64_t)hub_row_integer(rows, i, FIRST_FURTHER);
        error = each(context, &outlet);
    }
    PQclear(rows);
    return error;
}

static int open_secret(struct hub_store *store, const PGresult *rows, struct hub__outlet_row *out,
                       struct iso_fault *fault)
{
    struct iso_fleet_bytes plain = {.bytes = NULL};
    size_t size = 0;
    const uint8_t *sealed = hub_row_bytes(rows, 0, FIRST_FURTHER, &size);
    if (!sealed) {
        return 0;
    }
    int error = hub_keys_open(&store->keys, "outlet-secret", &out->outlet.id, sealed, size, &plain);
    if (!error && plain.size >= sizeof out->secret) {
        error = -EBADMSG;
    }
    if (!error) {
        memcpy(out->secret, plain.bytes, plain.size);
        out->secret[plain.size] = '\0';
    }
    iso_fleet_bytes_free(&plain);
    return error == -ENOMEM ? iso_fault_set(fault, error, "%s: no memory", out->outlet.name)
           : error          ? iso_fault_set(fault, -EBADMSG,
                                            "%s: the secret cannot be opened: it is damaged, or the "
                                                     "key file belongs to another database",
                                            out->outlet.name)
                            : 0;
}

static int take_whole(struct hub_store *store, const PGresult *rows, struct hub__outlet_row *out,
                      struct iso_fault *fault)
{
    struct hub__outlet_row row = {.next_attempt_ms = hub_row_integer(rows, 0, NEXT_ATTEMPT)};
    take(rows, 0, &row.outlet);
    int error = open_secret(store, rows, &row, fault);
    if (!error && row.outlet.has_ca) {
        row.ca = strdup(hub_row_text(rows, 0, FIRST_FURTHER + 1));
        error = row.ca ? 0 : iso_fault_set(fault, -ENOMEM, "%s: no memory", row.outlet.name);
    }
    if (error) {
        hub__outlet_wipe(&row);
        return error;
    }
    *out = row;
    sodium_memzero(row.secret, sizeof row.secret);
    return 0;
}

int hub__outlet_load(struct hub_store *store, const struct iso_fleet_id *id, const char *name,
                     struct hub__outlet_row *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, id);
    hub_value_text(&values, name);
    int error = hub_db_run(store->db,
                           "SELECT " COLUMNS ", o.secret, o.ca FROM outlet o "
                           "WHERE o.id = $1 OR o.name = $2",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    error = PQntuples(rows) == 0
                ? iso_fault_set(fault, -ENOENT, "%s: there is no such outlet", name ? name : "it")
                : take_whole(store, rows, out, fault);
    PQclear(rows);
    return error;
}

void hub__outlet_wipe(struct hub__outlet_row *row)
{
    free(row->ca);
    row->ca = NULL;
    sodium_memzero(row->secret, sizeof row->secret);
}
