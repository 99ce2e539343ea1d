/* The hub's measurements as a file for the textfile collector of Prometheus's node_exporter, so
 * that the hub needs no further port. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>

#include "drivers/file/data_file.h"
#include "enroll/hub/serve/service.h"
#include "enroll/hub/store/hub_zone.h"

enum { EVERY_S = 15 };

static int write_zone(void *context, const struct hub_zone *zone)
{
    FILE *out = context;
    char id[ISO_FLEET_ID_TEXT_SIZE];

    (void)iso_fleet_id_text(&zone->place.zone, id);
    (void)fprintf(out, "isotherm_zone_sequence{zone=\"%s\"} %llu\n", id,
                  (unsigned long long)zone->place.sequence);
    (void)fprintf(out, "isotherm_zone_unpublished{zone=\"%s\"} %llu\n", id,
                  (unsigned long long)(zone->place.sequence - zone->published));
    (void)fprintf(out, "isotherm_zone_people{zone=\"%s\"} %llu\n", id,
                  (unsigned long long)zone->people);
    (void)fprintf(out, "isotherm_zone_lockdown{zone=\"%s\"} %d\n", id, zone->lockdown);
    (void)fprintf(out, "isotherm_zone_behind{zone=\"%s\"} %d\n", id, zone->behind);
    return 0;
}

static void write_doors(FILE *out, struct hub_service *service)
{
    PGresult *rows = NULL;

    if (hub_db_run(service->store.db,
                   "SELECT count(*) FILTER (WHERE joined_s > 0), count(*) FILTER (WHERE online) "
                   "FROM door WHERE expelled_s = 0",
                   NULL, &rows, NULL) == 0) {
        (void)fprintf(out, "isotherm_hub_doors_joined %lld\nisotherm_hub_doors_online %lld\n",
                      (long long)hub_row_integer(rows, 0, 0),
                      (long long)hub_row_integer(rows, 0, 1));
        PQclear(rows);
    }
}

static void write_totals(FILE *out, const struct hub_service *service)
{
    const struct hub_totals *t = &service->totals;
    const struct {
        const char *name;
        uint64_t value;
    } totals[] = {
        {"messages_total{kind=\"question\"}", t->questions},
        {"messages_total{kind=\"events\"}", t->events},
        {"messages_total{kind=\"request\"}", t->requests},
        {"messages_refused_total", t->refused},
        {"messages_dropped_total", service->mail.dropped},
        {"messages_waiting", service->mail.n},
        {"emitted_total", t->emitted},
        {"publish_failures_total", t->publish_failures},
        {"takeovers_total", t->takeovers},
        {"joins_total", t->joins},
        {"joins_refused_total", t->joins_refused},
        {"fetches_total", t->fetches},
        {"fetches_refused_total", t->fetches_refused},
        {"renewals_total", t->renewals},
        {"leader", service->is_leader},
        {"broker_connected", hub_mqtt_is_connected(service->mqtt)},
        {"database_connected", !service->database_lost},
    };

    for (size_t i = 0; i < sizeof totals / sizeof *totals; i++) {
        (void)fprintf(out, "isotherm_hub_%s %llu\n", totals[i].name,
                      (unsigned long long)totals[i].value);
    }
    (void)fprintf(out, "isotherm_hub_longest_call_seconds %.3f\n", t->longest_s);
    (void)fprintf(out, "isotherm_hub_longest_fetch_seconds %.3f\n", t->longest_fetch_s);
}

void hub__metrics_write(struct hub_service *service)
{
    const char *path = service->options->metrics_file;
    const int64_t now_s = (int64_t)hub__clock_s();
    struct iso_fault fault = {.text = ""};
    char *text = NULL;
    size_t size = 0;

    if (!path || now_s - service->measured_s < EVERY_S) {
        return;
    }
    FILE *out = open_memstream(&text, &size);
    if (!out) {
        return;
    }
    service->measured_s = now_s;
    write_totals(out, service);
    (void)!hub_zone_each(&service->store, write_zone, out, NULL);
    write_doors(out, service);
    if (fclose(out) == 0 && iso_data_file_replace(path, text, size, &fault)) {
        fprintf(stderr, SD_WARNING "isotherm-hub: %s\n", fault.text);
    }
    (void)chmod(path, 0644);
    free(text);
}
