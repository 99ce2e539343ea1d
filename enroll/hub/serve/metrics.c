/* The hub's measurements as a file for the textfile collector of Prometheus's node_exporter, so
 * that the hub needs no further port. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>

#include "drivers/file/data_file.h"
#include "enroll/hub/metrics/hub_metrics.h"
#include "enroll/hub/serve/service.h"

enum { EVERY_S = 15 };

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
        {"scim_requests_total", t->scim},
        {"scim_refused_total", t->scim_refused},
        {"scim_strangers_total", t->scim_strangers},
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
    /* Without the database its figures are left out; isotherm_hub_database_connected says why. */
    (void)!hub_metrics_write(&service->store, out, NULL);
    if (fclose(out) == 0 && iso_data_file_replace(path, text, size, &fault)) {
        fprintf(stderr, SD_WARNING "isotherm-hub: %s\n", fault.text);
    }
    (void)chmod(path, 0644);
    free(text);
}
