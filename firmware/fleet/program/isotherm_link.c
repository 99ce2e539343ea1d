/* isotherm-link: connects the door to the hub of its fleet. It has the network and no secret of the
 * fleet but the key of its own certificate; the daemon has the people and no network. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "firmware/fleet/link/link_bus.h"
#include "firmware/fleet/program/figures.h"
#include "firmware/fleet/program/join.h"
#include "firmware/fleet/program/options.h"
#include "firmware/fleet/program/renew.h"
#include "firmware/fleet/program/service.h"
#include "firmware/fleet/update/update.h"

/* As in enroll/cli/client/fault.h. */
enum { EXIT_NO = 1, EXIT_USAGE = 2, EXIT_NOT_FOUND = 3, EXIT_FAULT = 4 };

static int fault_exit(int error, const struct iso_fault *fault)
{
    fprintf(stderr, "isotherm-link: %s\n", fault->text);
    switch (error) {
    case -EINVAL:
        return EXIT_USAGE;
    case -ENOENT:
        return EXIT_NOT_FOUND;
    case -EALREADY:
    case -EACCES:
    case -EKEYREJECTED:
        return EXIT_NO;
    default:
        return EXIT_FAULT;
    }
}

static void on_came(void *context)
{
    (void)context;
}

static void on_work(void *context, const char *what)
{
    (void)context;
    (void)what;
}

static int join(struct link_bus *bus, const struct link_options *options, struct iso_fault *fault)
{
    struct link_home home;
    char door[ISO_FLEET_ID_TEXT_SIZE];
    const int r = link_join(bus, options->state, options->address, &home, fault);

    if (r == 0) {
        printf("the door belongs to the fleet of %s, as %s\n", home.hub_url,
               iso_fleet_id_text(&home.door, door));
    }
    return r;
}

static int leave(struct link_bus *bus, const struct link_options *options, struct iso_fault *fault)
{
    const int r = link_leave(bus, options->state, fault);

    if (r == 0) {
        link_update_forget(options->state, options->updates);
        puts("the door belongs to no fleet");
    }
    return r;
}

static void print_certificate(const struct link_options *options)
{
    struct iso_fault fault = {.text = ""};
    char date[32] = "";
    bool is_due = false;
    int64_t ends_s = 0;

    if (link_renew_look(options->state, time(NULL), &is_due, &ends_s, &fault) < 0) {
        printf("certificate  %s\n", fault.text);
        return;
    }
    const time_t ends = (time_t)ends_s;
    struct tm parts;
    if (gmtime_r(&ends, &parts)) {
        (void)strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", &parts);
    }
    printf("certificate  until %s%s\n", date, is_due ? ", will be renewed" : "");
}

static void print_zones(const struct iso_link_status *status)
{
    char zone[ISO_FLEET_ID_TEXT_SIZE];

    for (size_t i = 0; i < status->n; i++) {
        printf("zone         %s, change %llu, epoch %llu%s\n",
               iso_fleet_id_text(&status->places[i].zone, zone),
               (unsigned long long)status->places[i].sequence,
               (unsigned long long)status->places[i].epoch,
               status->wants_snapshot[i] ? ", waits for a snapshot" : "");
    }
}

static int print_metrics(const struct iso_link_status *status, const struct link_bus_lease *lease,
                         const struct link_options *options, struct iso_fault *fault)
{
    struct link_report report;
    bool is_due = false;
    int64_t ends_s = 0;

    if (link_renew_look(options->state, time(NULL), &is_due, &ends_s, NULL) < 0) {
        ends_s = 0;
    }
    link_figures_write(stdout, status, lease, ends_s, link_figures_find(&report) ? &report : NULL);
    return fflush(stdout) ? iso_fault_set(fault, -EIO, "standard output: %s", strerror(errno)) : 0;
}

static int print_status(struct link_bus *bus, const struct link_options *options,
                        struct iso_fault *fault)
{
    struct iso_link_status status;
    struct link_bus_lease lease;
    struct link_home home;
    char door[ISO_FLEET_ID_TEXT_SIZE];
    const int r = link_bus_status(bus, &status, &lease, fault);

    if (r < 0) {
        return r;
    }
    if (options->metrics) {
        return print_metrics(&status, &lease, options, fault);
    }
    printf("door         %s, %s\n", lease.door_name, iso_fleet_id_text(&status.door, door));
    printf("hub          %s\n", lease.hub_name);
    if (link_home_read(options->state, &home, NULL) == 0) {
        printf("address      %s, broker %s:%u\n", home.hub_url, home.broker_host, home.broker_port);
        print_certificate(options);
    }
    printf("lease        %s, %lld s left\n", lease.word, (long long)lease.left_s);
    printf("events       %llu of %llu are at the hub\n", (unsigned long long)status.acked,
           (unsigned long long)status.last_event);
    printf("pending      %u people wait for approval\n", lease.pending);
    print_zones(&status);
    if (*lease.fault) {
        printf("fault        %s\n", lease.fault);
    }
    if (lease.is_hub_behind) {
        puts("the hub knows less than this door: it was restored from an older copy");
    }
    return 0;
}

static int command(const struct link_options *options, struct iso_fault *fault)
{
    const struct link_bus_calls calls = {.came = on_came, .work = on_work};
    struct link_bus *bus = NULL;
    sd_event *event = NULL;
    int r = sd_event_new(&event);

    r = r < 0 ? iso_fault_set(fault, r, "the event loop cannot be made")
              : link_bus_new(event, options->bus, &calls, &bus, fault);
    if (r == 0) {
        r = options->command == LINK_COMMAND_JOIN    ? join(bus, options, fault)
            : options->command == LINK_COMMAND_LEAVE ? leave(bus, options, fault)
                                                     : print_status(bus, options, fault);
    }
    link_bus_free(bus);
    (void)sd_event_unref(event);
    return r;
}

int main(int argc, char **argv)
{
    struct link_options options;
    struct iso_fault fault = {.text = ""};
    int r = link_options_read(argc, argv, &options);

    if (r) {
        return r < 0 ? EXIT_USAGE : EXIT_SUCCESS;
    }
    r = iso_fleet_start(&fault);
    if (r == 0) {
        r = options.command == LINK_COMMAND_RUN ? link_service_run(&options, &fault)
                                                : command(&options, &fault);
    }
    return r < 0 ? fault_exit(r, &fault) : EXIT_SUCCESS;
}
