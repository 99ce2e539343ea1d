#include "enroll/hub/metrics/hub_metrics.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "enroll/hub/answer/hub_outbox.h"

/* A metric: its name behind "isotherm_fleet_", and what it says. Names that end with _total only
 * grow. */
struct metric {
    const char *name, *help;
};

/* Several metrics from one statement. Its first columns are the values of the labels, as texts;
 * each further column, a bigint, is the metric of its place. */
struct family {
    const char *labels[3]; /* ends with NULL */
    const struct metric *metrics;
    size_t n;
    const char *sql;
};

static const struct metric whole[] = {
    {"leader", "Whether a process of the hub leads and publishes"},
    {"doors_joined", "Doors that have joined"},
    {"doors_online", "Doors that the broker sees"},
    {"events_total", "Sum of the acknowledged numbers of the doors"},
    {"requests_pending", "People who wait for approval"},
    {"database_bytes", "Size of the database"},
};

static const struct metric doors[] = {
    {"door_reported_seconds", "The last report of a door, in seconds since 1970; 0: none"},
    {"door_online", "Whether the broker sees the door"},
};

static const struct metric zones[] = {
    {"zone_doors", "Doors that have joined"},
    {"zone_doors_behind", "Doors that have not confirmed what the zone has"},
    {"zone_people", "People"},
    {"zone_deltas_total", "Changes of the zone"},
    {"zone_published_total", "Changes that the broker has"},
    {"zone_epoch", "Epoch of the key"},
    {"zone_lockdown", "Whether the zone is closed to everybody"},
    {"zone_behind", "Whether a door knows more than the database"},
};

static const struct metric outlets[] = {
    {"outlet_delivered_total", "Events that were handed over"},
    {"outlet_waiting", "Acknowledged numbers that the outlet has not passed yet"},
    {"outlet_delivered_seconds", "The last success, in seconds since 1970; 0: none"},
    {"outlet_failures", "Failures since the last success"},
    {"outlet_stopped", "Whether the receiver has refused, so that the outlet was stopped"},
};

static const struct metric directory[] = {
    {"directory_people", "People whom a directory names or has named"},
};

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const struct family families[] = {
    {{NULL},
     whole,
     COUNT(whole),
     "SELECT (SELECT count(*) FROM pg_locks l JOIN pg_database b ON b.oid = l.database "
     "WHERE b.datname = current_database() AND l.locktype = 'advisory' AND l.granted "
     "AND l.objsubid = 1 AND (l.classid::bigint << 32 | l.objid::bigint) = " HUB_LEADER_LOCK "), "
     "count(*) FILTER (WHERE joined_s > 0 AND expelled_s = 0), "
     "count(*) FILTER (WHERE online AND expelled_s = 0), coalesce(sum(acked), 0)::bigint, "
     "(SELECT count(*) FROM request WHERE state = 0), pg_database_size(current_database()) "
     "FROM door"},
    {{"door", "name", NULL},
     doors,
     COUNT(doors),
     "SELECT id::text, name, reported_s, online::int::bigint FROM door "
     "WHERE joined_s > 0 AND expelled_s = 0 ORDER BY name, id"},
    {{"zone", "name", NULL},
     zones,
     COUNT(zones),
     "SELECT z.id::text, z.name, count(d.id), count(d.id) FILTER (WHERE p.door IS NULL "
     "OR p.epoch <> z.epoch OR p.sequence <> z.sequence OR p.digest <> z.digest), "
     "(SELECT count(*) FROM person_zone h WHERE h.zone = z.id), z.sequence, z.published, z.epoch, "
     "z.lockdown::int::bigint, z.behind::int::bigint FROM zone z "
     "LEFT JOIN door_zone dz ON dz.zone = z.id "
     "LEFT JOIN door d ON d.id = dz.door AND d.joined_s > 0 AND d.expelled_s = 0 "
     "LEFT JOIN door_place p ON p.door = d.id AND p.zone = z.id GROUP BY z.id ORDER BY z.name"},
    {{"outlet", NULL},
     outlets,
     COUNT(outlets),
     "SELECT o.name, o.delivered, (SELECT coalesce(sum(greatest(d.acked - coalesce(c.number, 0), "
     "0)), 0)::bigint FROM door d LEFT JOIN outlet_cursor c ON c.outlet = o.id AND c.door = d.id), "
     "o.delivered_s, o.failures, o.stopped::int::bigint FROM outlet o ORDER BY o.name"},
    {{"state", NULL},
     directory,
     COUNT(directory),
     "SELECT s.state, count(d.id) FROM (VALUES ('enrolled'), ('missing'), ('disabled'), "
     "('unnamed')) s (state) LEFT JOIN directory d ON s.state = CASE WHEN NOT d.named "
     "THEN 'unnamed' WHEN NOT d.active THEN 'disabled' WHEN d.person IS NULL THEN 'missing' "
     "ELSE 'enrolled' END GROUP BY s.state ORDER BY s.state"},
};

struct work {
    struct hub_store *store;
    PGresult *results[COUNT(families)];
};

static void clear(struct work *w)
{
    for (size_t i = 0; i < COUNT(families); i++) {
        PQclear(w->results[i]);
        w->results[i] = NULL;
    }
}

/* All figures are those of one moment. */
static int read_all(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    int error = 0;
    clear(w);
    for (size_t i = 0; !error && i < COUNT(families); i++) {
        error = hub_db_run(w->store->db, families[i].sql, NULL, &w->results[i], fault);
    }
    return error;
}

static void put_label(FILE *out, const char *name, const char *value, char before)
{
    (void)fprintf(out, "%c%s=\"", before, name);
    for (; *value; value++) {
        if (*value == '\n') {
            (void)fputs("\\n", out);
        } else {
            (void)fprintf(out, "%s%c", strchr("\"\\", *value) ? "\\" : "", *value);
        }
    }
    (void)fputc('"', out);
}

static void put_metric(FILE *out, const struct family *family, size_t which, const PGresult *rows)
{
    const struct metric *metric = &family->metrics[which];
    const size_t length = strlen(metric->name), total = strlen("_total");
    const bool grows = length > total && strcmp(metric->name + length - total, "_total") == 0;
    int n_labels = 0;
    while (family->labels[n_labels]) {
        n_labels++;
    }
    (void)fprintf(out, "# HELP isotherm_fleet_%s %s.\n# TYPE isotherm_fleet_%s %s\n", metric->name,
                  metric->help, metric->name, grows ? "counter" : "gauge");
    for (int row = 0; row < PQntuples(rows); row++) {
        (void)fprintf(out, "isotherm_fleet_%s", metric->name);
        for (int i = 0; i < n_labels; i++) {
            put_label(out, family->labels[i], hub_row_text(rows, row, i), i == 0 ? '{' : ',');
        }
        (void)fprintf(out, "%s %" PRId64 "\n", n_labels > 0 ? "}" : "",
                      hub_row_integer(rows, row, n_labels + (int)which));
    }
}

int hub_metrics_write(struct hub_store *store, FILE *out, struct iso_fault *fault)
{
    struct work w = {.store = store};
    const int error = hub_db_transaction(store->db, HUB_REPEATABLE_READ, read_all, &w, fault);
    for (size_t i = 0; !error && i < COUNT(families); i++) {
        for (size_t k = 0; k < families[i].n; k++) {
            put_metric(out, &families[i], k, w.results[i]);
        }
    }
    clear(&w);
    return error;
}

/* Writes a stream to its end; the file is closed in any case. */
static int finish(struct hub_store *store, int fd, const char *path, struct iso_fault *fault)
{
    FILE *out = fdopen(fd, "w");
    if (!out) {
        (void)close(fd);
        return iso_fault_set(fault, -ENOMEM, "%s: no memory", path);
    }
    int error = hub_metrics_write(store, out, fault);
    const bool failed = fflush(out) || ferror(out) || fchmod(fd, 0644);
    const int why = errno;
    if ((fclose(out) || failed) && !error) {
        error = iso_file_fault(path, why ? -why : -EIO, fault);
    }
    return error;
}

int hub_metrics_file(struct hub_store *store, const char *path, struct iso_fault *fault)
{
    char *fresh = NULL;
    int fd = -1;
    if (asprintf(&fresh, "%s.new", path) < 0) {
        return iso_fault_set(fault, -ENOMEM, "%s: no memory", path);
    }
    int error = iso_file_open(fresh, O_WRONLY | O_CREAT | O_TRUNC, ISO_FILE_ANY_SIZE, &fd, fault);
    if (!error) {
        error = finish(store, fd, fresh, fault);
        if (!error && rename(fresh, path)) {
            error = iso_file_fault(path, -errno, fault);
        }
        if (error) {
            (void)unlink(fresh);
        }
    }
    free(fresh);
    return error;
}
