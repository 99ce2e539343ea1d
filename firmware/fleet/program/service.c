#include "firmware/fleet/program/service.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <systemd/sd-event.h>
#include <time.h>

#include "drivers/process/service_loop.h"
#include "firmware/fleet/link/link.h"
#include "firmware/fleet/link/link_bus.h"
#include "firmware/fleet/program/figures.h"
#include "firmware/fleet/program/home.h"
#include "firmware/fleet/program/renew.h"
#include "firmware/fleet/update/update.h"

enum {
    LOOK_S = 5,
    RENEW_FIRST_S = 60, /* after the start, so that many doors do not begin with it */
    RENEW_FAILED_S = 3600,
    RENEW_LOOK_S = 6 * 3600,
    RENEW_DONE_S = 24 * 3600,
    NOTE_SIZE = 384,
    QUIET_S = 60, /* nobody was at the door, before a restart */
};

struct service {
    const struct link_options *options;
    sd_event *event;
    sd_event_source *look, *renew;
    struct link_bus *bus;
    struct link_http *http;
    struct link_door *door; /* NULL: NONE */
    struct link_update *update;
    struct link_home home;
    struct timespec changed; /* of link.json, when the link was made */
    char last_note[NOTE_SIZE];
    enum link_phase last_phase;
};

/* A broker that stays away causes the same line again and again; it is written once. */
static void on_note(void *context, const char *line)
{
    struct service *service = context;

    if (strcmp(service->last_note, line) != 0) {
        (void)snprintf(service->last_note, sizeof service->last_note, "%s", line);
        fprintf(stderr, "isotherm-link: %s\n", line);
    }
}

/* ---- updates of the image ---- */

static void on_ordered(void *context, const struct iso_fleet_update *order)
{
    struct service *service = context;

    link_update_ordered(service->update, order);
}

static void on_answered(void *context)
{
    struct service *service = context;

    link_update_answered(service->update);
}

static int start_update(struct service *service, const char *ca, struct iso_fault *fault)
{
    const struct link_options *options = service->options;
    const struct link_update_setup setup = {.event = service->event,
                                            .daemon = link_bus_daemon(service->bus),
                                            .http = service->http,
                                            .hub_url = service->home.hub_url,
                                            .ca_file = ca,
                                            .folder = options->state,
                                            .program = ISOTHERM_PROGRAM,
                                            .updates = options->updates,
                                            .restart = options->restart,

                                            .quiet_s = QUIET_S,
                                            .note = on_note,
                                            .note_context = service};
    return link_update_new(&setup, &service->update, fault);
}

/* ---- the link ---- */

static int start_link(struct service *service, struct iso_fault *fault)
{
    const char *folder = service->options->state;
    char ca[PATH_MAX], certificate[PATH_MAX], key[PATH_MAX];
    int r = link_home_path(ca, folder, LINK_HOME_CA, fault);

    r = r < 0 ? r : link_home_path(certificate, folder, LINK_HOME_CERTIFICATE, fault);
    r = r < 0 ? r : link_home_path(key, folder, LINK_HOME_KEY, fault);
    if (r < 0) {
        return r;
    }
    const struct link_setup setup = {.event = service->event,
                                     .daemon = link_bus_daemon(service->bus),
                                     .http = service->http,
                                     .broker = {.host = service->home.broker_host,
                                                .port = service->home.broker_port,
                                                .ca_file = ca,
                                                .certificate_file = certificate,
                                                .key_file = key},
                                     .hub_url = service->home.hub_url,
                                     .folder = folder,
                                     .update_context = service,
                                     .ordered = on_ordered,
                                     .answered = on_answered,
                                     .note = on_note,
                                     .note_context = service};
    r = start_update(service, ca, fault);
    return r < 0 ? r : link_door_new(&setup, &service->door, fault);
}

static void stop_link(struct service *service)
{
    link_door_free(service->door);
    service->door = NULL;
    link_update_free(service->update);
    service->update = NULL;
}

static bool has_changed(const struct service *service, struct timespec *now)
{
    char path[PATH_MAX];
    struct stat file;

    *now = (struct timespec){.tv_sec = 0};
    if (link_home_path(path, service->options->state, LINK_HOME_CONF, NULL) == 0 &&
        stat(path, &file) == 0) {
        *now = file.st_ctim;
    }
    return now->tv_sec != service->changed.tv_sec || now->tv_nsec != service->changed.tv_nsec;
}

static void say_phase(struct service *service)
{
    const enum link_phase phase = service->door ? link_door_report(service->door).phase
                                                : LINK_PHASES;

    if (phase != service->last_phase) {
        service->last_phase = phase;
        (void)sd_notifyf(0, "STATUS=%s",
                         service->door ? link_phase_word(phase) : "the door belongs to no fleet");
    }
}

static void follow_home(struct service *service)
{
    struct iso_fault fault = {.text = ""};
    struct timespec now;

    if (!has_changed(service, &now)) {
        return;
    }
    service->changed = now;
    stop_link(service);
    if (now.tv_sec == 0) {
        link_update_forget(service->options->state, service->options->updates);
        return;
    }
    int r = link_home_read(service->options->state, &service->home, &fault);
    r = r < 0 ? r : start_link(service, &fault);
    if (r < 0) {
        on_note(service, fault.text);
    }
}

static int on_look(sd_event_source *source, uint64_t at_us, void *context)
{
    struct service *service = context;

    (void)at_us;
    follow_home(service);
    say_phase(service);
    if (service->door) {
        const struct link_report report = link_door_report(service->door);
        link_figures_keep(&report);
    }
    (void)sd_event_source_set_time_relative(source, LOOK_S * UINT64_C(1000000));
    return sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

/* ---- the certificate ---- */

static uint64_t renew_if_due(struct service *service)
{
    struct iso_fault fault = {.text = ""};
    bool is_due = false;
    int64_t ends_s = 0;
    int r = link_renew_look(service->options->state, time(NULL), &is_due, &ends_s, &fault);

    if (r == 0 && !is_due) {
        return RENEW_LOOK_S;
    }
    r = r < 0 ? r : link_renew(service->options->state, &service->home, &fault);
    if (r < 0) {
        on_note(service, fault.text);
        return RENEW_FAILED_S;
    }
    fprintf(stderr, "isotherm-link: the certificate of the door is new\n");
    link_door_renew(service->door);
    return RENEW_DONE_S;
}

static int on_renew(sd_event_source *source, uint64_t at_us, void *context)
{
    struct service *service = context;
    const uint64_t wait_s = service->door ? renew_if_due(service) : RENEW_FIRST_S;

    (void)at_us;
    (void)sd_event_source_set_time_relative(source, wait_s * UINT64_C(1000000));
    return sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

/* ---- the daemon ---- */

static void on_came(void *context)
{
    struct service *service = context;

    if (service->door) {
        link_door_wake(service->door);
    }
}

static void on_work(void *context, const char *what)
{
    struct service *service = context;

    if (service->door) {
        link_door_work(service->door, what);
    }
}

/* ---- begin and end ---- */

static int open_loop(struct service *service, struct iso_fault *fault)
{
    int r = iso_service_loop_open(&service->event);

    r = r < 0 ? r
              : sd_event_add_time_relative(service->event, &service->look, CLOCK_BOOTTIME, 0,
                                           100000, on_look, service);
    r = r < 0 ? r
              : sd_event_add_time_relative(service->event, &service->renew, CLOCK_BOOTTIME,
                                           RENEW_FIRST_S * UINT64_C(1000000), 1000000, on_renew,
                                           service);
    return r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r)) : 0;
}

int link_service_run(const struct link_options *options, struct iso_fault *fault)
{
    struct service service = {.options = options, .last_phase = LINK_PHASES};
    const struct link_bus_calls calls = {.context = &service, .came = on_came, .work = on_work};
    int r = open_loop(&service, fault);

    if (link_home_read(options->state, &service.home, NULL) == -ENOENT) {
        link_update_forget(options->state,
                           options->updates); /* it has left, or was reset, while no link ran */
    }
    r = r < 0 ? r : link_bus_new(service.event, options->bus, &calls, &service.bus, fault);
    r = r < 0 ? r : link_http_new(service.event, &service.http, fault);
    if (r == 0) {
        (void)sd_notify(0, "READY=1\nSTATUS=the door belongs to no fleet");
        r = sd_event_loop(service.event);
        (void)sd_notify(0, "STOPPING=1");
        if (r < 0) {
            (void)iso_fault_set(fault, r, "the event loop: %s", strerror(-r));
        }
    }
    stop_link(&service);
    link_http_free(service.http);
    link_bus_free(service.bus);
    (void)sd_event_source_disable_unref(service.look);
    (void)sd_event_source_disable_unref(service.renew);
    (void)sd_event_unref(service.event);
    return r < 0 ? r : 0;
}
