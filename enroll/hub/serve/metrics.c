/* The hub's figures for Prometheus: as a file for the textfile collector of node_exporter, and as
 * the answer to GET /metrics of a program on the same machine. */
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>

#include "drivers/file/data_file.h"
#include "enroll/hub/metrics/hub_metrics.h"
#include "enroll/hub/serve/service.h"

enum { EVERY_S = 15 };

/* One figure of this process. Figures of one name, with different labels, stand together. */
struct figure {
    const char *name, *labels, *help;
    uint64_t value;
};

/* A name that ends with _total only grows. */
static bool grows(const char *name)
{
    static const char total[] = "_total";
    const size_t n = strlen(name);

    return n > sizeof total && strcmp(name + n - (sizeof total - 1), total) == 0;
}

static void write_head(FILE *out, const char *name, const char *help, bool is_counter)
{
    (void)fprintf(out, "# HELP isotherm_hub_%s %s.\n# TYPE isotherm_hub_%s %s\n", name, help, name,
                  is_counter ? "counter" : "gauge");
}

static void write_seconds(FILE *out, const char *name, const char *help, double seconds)
{
    write_head(out, name, help, false);
    (void)fprintf(out, "isotherm_hub_%s %.3f\n", name, seconds);
}

static void write_totals(FILE *out, const struct hub_service *service)
{
    static const char pruned[] = "Rows that were deleted because of their age";
    static const char messages[] = "Messages of doors by their kind";
    const struct hub_totals *t = &service->totals;
    const struct figure figures[] = {
        {"messages_total", "{kind=\"question\"}", messages, t->questions},
        {"messages_total", "{kind=\"events\"}", messages, t->events},
        {"messages_total", "{kind=\"request\"}", messages, t->requests},
        {"messages_refused_total", "", "Messages of doors that were refused", t->refused},
        {"messages_dropped_total", "", "Messages for which there was no room",
         service->mail.dropped},
        {"questions_replaced_total", "", "Questions that a later one of the same door has replaced",
         service->mail.replaced},
        {"messages_waiting", "", "Messages that wait for the database", service->mail.n},
        {"emitted_total", "", "Messages that were handed to the broker", t->emitted},
        {"publish_failures_total", "", "Attempts to publish that failed", t->publish_failures},
        {"takeovers_total", "", "How often this process has become the leader", t->takeovers},
        {"joins_total", "", "Doors that have joined", t->joins},
        {"joins_refused_total", "", "Attempts to join that were refused", t->joins_refused},
        {"fetches_total", "", "Fetches that were answered", t->fetches},
        {"fetches_refused_total", "", "Fetches that were refused", t->fetches_refused},
        {"renewals_total", "", "Certificates that were renewed", t->renewals},
        {"scim_requests_total", "", "Requests of SCIM", t->scim},
        {"scim_refused_total", "", "Requests of SCIM that were refused", t->scim_refused},
        {"scim_strangers_total", "", "Requests of SCIM without a valid token", t->scim_strangers},
        {"pruned_total", "{kind=\"delta\"}", pruned, t->pruned.deltas},
        {"pruned_total", "{kind=\"event\"}", pruned, t->pruned.events},
        {"pruned_total", "{kind=\"act\"}", pruned, t->pruned.acts},
        {"leader", "", "Whether this process leads and publishes", service->is_leader},
        {"broker_connected", "", "Whether the broker is connected",
         hub_mqtt_is_connected(service->mqtt)},
        {"database_connected", "", "Whether the database answers", !service->database_lost},
    };

    for (size_t i = 0; i < sizeof figures / sizeof *figures; i++) {
        const struct figure *f = &figures[i];
        if (i == 0 || strcmp(f->name, figures[i - 1].name) != 0) {
            write_head(out, f->name, f->help, grows(f->name));
        }
        (void)fprintf(out, "isotherm_hub_%s%s %llu\n", f->name, f->labels,
                      (unsigned long long)f->value);
    }
    write_seconds(out, "longest_call_seconds", "The longest call of the database in the event loop",
                  t->longest_s);
    write_seconds(out, "longest_fetch_seconds", "The longest answer to a fetch",
                  t->longest_fetch_s);
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

/* ---- GET /metrics ---- */

/* An answer on its way through the thread that has the database. */
struct scrape {
    struct web_exchange *exchange;
    FILE *out;
    char *text;
    size_t size;
};

/* In the thread. Without the database its figures are left out, as in the file. */
static void scrape_fleet(void *context, struct hub_store *store)
{
    struct scrape *scrape = context;

    (void)!hub_metrics_write(store, scrape->out, NULL);
}

static void end_scrape(void *context, bool is_done)
{
    struct scrape *scrape = context;
    const bool ok = fclose(scrape->out) == 0 && is_done;

    if (ok) {
        web_exchange_typed(scrape->exchange, 200, "text/plain; version=0.0.4; charset=utf-8",
                           scrape->text, scrape->size);
    } else {
        web_exchange_problem(scrape->exchange, 503, "busy", "the hub cannot answer now");
        free(scrape->text);
    }
    free(scrape);
}

/* Whether the client is a program on this machine. A proxy on this machine would let everybody in,
 * so what a proxy has passed on does not count. */
static bool is_near(const struct web_exchange *exchange)
{
    static const char *const proxied[] = {"Forwarded", "X-Forwarded-For", "X-Real-IP", "Via"};
    const struct sockaddr *address = web_exchange_address(exchange);
    struct in6_addr ip;

    for (size_t i = 0; i < sizeof proxied / sizeof *proxied; i++) {
        if (web_exchange_request_header(exchange, proxied[i])) {
            return false;
        }
    }
    if (address->sa_family == AF_INET) {
        const struct sockaddr_in *v4 = (const void *)address;
        return ntohl(v4->sin_addr.s_addr) >> 24 == IN_LOOPBACKNET;
    }
    if (address->sa_family != AF_INET6) {
        return false;
    }
    ip = ((const struct sockaddr_in6 *)(const void *)address)->sin6_addr;
    return IN6_IS_ADDR_LOOPBACK(&ip) ||
           (IN6_IS_ADDR_V4MAPPED(&ip) && ip.s6_addr[12] == IN_LOOPBACKNET);
}

void hub__get_metrics(void *context, struct web_exchange *exchange)
{
    struct hub_service *service = context;

    if (!is_near(exchange)) {
        web_exchange_problem(exchange, 403, "not-allowed",
                             "the figures are for programs on the hub's own machine");
        return;
    }
    struct scrape *scrape = calloc(1, sizeof *scrape);
    if (scrape) {
        scrape->exchange = exchange;
        scrape->out = open_memstream(&scrape->text, &scrape->size);
    }
    if (!scrape || !scrape->out) {
        free(scrape);
        web_exchange_problem(exchange, 503, "busy", "the hub has no memory for the answer");
        return;
    }
    write_totals(scrape->out, service);
    const struct hub_task task = {.work = scrape_fleet, .done = end_scrape, .context = scrape};
    if (hub_worker_do(service->api.worker, HUB_LANE_LOOKS, &task)) {
        end_scrape(scrape, false);
    }
}
