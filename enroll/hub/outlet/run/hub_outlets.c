#include "enroll/hub/outlet/run/hub_outlets.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-daemon.h>

#include "enroll/hub/outlet/run/outlet_worker.h"

enum { OUTLETS_MOST = 64, FOLLOW_US = 2000000 };

struct hub_outlets {
    struct hub_store *store;
    const struct hub_store_options *options;
    sd_event_source *timer;
    size_t n;
    struct hub__worker *workers[OUTLETS_MOST];
};

static size_t find(const struct hub_outlets *outlets, const struct iso_fleet_id *id)
{
    size_t i = 0;
    while (i < outlets->n && !iso_fleet_id_is_same(hub__worker_outlet(outlets->workers[i]), id)) {
        i++;
    }
    return i;
}

static bool has(const PGresult *rows, const struct iso_fleet_id *id)
{
    for (int i = 0; i < PQntuples(rows); i++) {
        const struct iso_fleet_id row = hub_row_id(rows, i, 0);
        if (iso_fleet_id_is_same(&row, id)) {
            return true;
        }
    }
    return false;
}

static void end_removed(struct hub_outlets *outlets, const PGresult *rows)
{
    for (size_t i = outlets->n; i-- > 0;) {
        if (!has(rows, hub__worker_outlet(outlets->workers[i]))) {
            hub__worker_free(outlets->workers[i]);
            outlets->workers[i] = outlets->workers[--outlets->n];
        }
    }
}

static void start_new(struct hub_outlets *outlets, const PGresult *rows)
{
    struct iso_fault fault = {.text = ""};
    for (int i = 0; i < PQntuples(rows) && outlets->n < OUTLETS_MOST; i++) {
        const struct iso_fleet_id id = hub_row_id(rows, i, 0);
        if (find(outlets, &id) < outlets->n) {
            continue;
        }
        if (hub__worker_start(outlets->options, &id, &outlets->workers[outlets->n], &fault)) {
            fprintf(stderr, SD_ERR "isotherm-hub: %s\n", fault.text);
            return; /* it is tried again with the next look */
        }
        outlets->n++;
    }
}

/* Whether the database is away is said by others. */
static void follow(struct hub_outlets *outlets)
{
    PGresult *rows = NULL;
    if (hub_db_run(outlets->store->db, "SELECT id FROM outlet ORDER BY added_s, id", NULL, &rows,
                   NULL) == 0) {
        end_removed(outlets, rows);
        start_new(outlets, rows);
        PQclear(rows);
    }
}

static int on_time(sd_event_source *source, uint64_t usec, void *context)
{
    (void)usec;
    follow(context);
    return sd_event_source_set_time_relative(source, FOLLOW_US);
}

int hub_outlets_new(sd_event *event, struct hub_store *store,
                    const struct hub_store_options *options, struct hub_outlets **out,
                    struct iso_fault *fault)
{
    struct hub_outlets *outlets = calloc(1, sizeof *outlets);
    if (!outlets) {
        return iso_fault_set(fault, -ENOMEM, "outlets: no memory");
    }
    outlets->store = store;
    outlets->options = options;
    int error = sd_event_add_time_relative(event, &outlets->timer, CLOCK_MONOTONIC, FOLLOW_US, 0,
                                           on_time, outlets);
    error = error < 0 ? error : sd_event_source_set_enabled(outlets->timer, SD_EVENT_ON);
    if (error < 0) {
        hub_outlets_free(outlets);
        return iso_fault_set(fault, error, "outlets: %s", strerror(-error));
    }
    follow(outlets);
    *out = outlets;
    return 0;
}

void hub_outlets_free(struct hub_outlets *outlets)
{
    if (!outlets) {
        return;
    }
    sd_event_source_disable_unref(outlets->timer);
    /* All are asked before the first one is waited for. */
    for (size_t i = 0; i < outlets->n; i++) {
        hub__worker_ask_to_end(outlets->workers[i]);
    }
    for (size_t i = 0; i < outlets->n; i++) {
        hub__worker_free(outlets->workers[i]);
    }
    free(outlets);
}
