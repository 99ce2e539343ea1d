/* Many simulated doors (memory_door.h) in one process, until SIGTERM.
 *
 *   fleet_crowd TABLE FIRST COUNT FOLDER HOST PORT HUB-URL
 *
 * FOLDER has ca.pem, and NUMBER.pem and NUMBER-key.pem of each door (fleet_bench join). */
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-event.h>

#include "tests/bench/fleet/memory_door.h"

enum { STEP_US = 500000 };

struct crowd {
    sd_event *event;
    struct link_http *http;
    struct fleet_table *table;
    struct memory_door **doors;
    uint32_t first, n;
};

static _Noreturn void fail(const char *what, int error)
{
    fprintf(stderr, "fleet_crowd: %s: %s\n", what, strerror(error));
    exit(4);
}

static int on_step(sd_event_source *source, uint64_t now_us, void *context)
{
    struct crowd *crowd = context;
    const uint64_t visits = atomic_load(&crowd->table->visits);
    (void)now_us;
    for (uint32_t i = 0; i < crowd->n; i++) {
        memory_door_step(crowd->doors[i], visits);
    }
    (void)sd_event_source_set_time_relative(source, STEP_US);
    return sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

static void make_doors(struct crowd *crowd, char **words)
{
    const char *folder = words[0], *host = words[1], *url = words[3];
    char ca[PATH_MAX], certificate[PATH_MAX], key[PATH_MAX];
    (void)snprintf(ca, sizeof ca, "%s/ca.pem", folder);
    for (uint32_t i = 0; i < crowd->n; i++) {
        const uint32_t number = crowd->first + i;
        (void)snprintf(certificate, sizeof certificate, "%s/%u.pem", folder, number);
        (void)snprintf(key, sizeof key, "%s/%u-key.pem", folder, number);
        const struct memory_door_setup setup = {
            .event = crowd->event,
            .http = crowd->http,
            .broker = {.host = host,
                       .port = (uint16_t)atoi(words[2]),
                       .ca_file = ca,
                       .certificate_file = certificate,
                       .key_file = key},
            .hub_url = url,
            .row = &crowd->table->doors[number],
        };
        crowd->doors[i] = memory_door_new(&setup);
    }
}

int main(int argc, char **argv)
{
    static struct crowd crowd;
    struct iso_fault fault = {.text = ""};
    sd_event_source *step = NULL;
    sigset_t ends;
    if (argc != 8) {
        fprintf(stderr, "usage: fleet_crowd TABLE FIRST COUNT FOLDER HOST PORT HUB-URL\n");
        return 2;
    }
    crowd.table = fleet_table_open(argv[1]);
    crowd.first = (uint32_t)atoi(argv[2]);
    crowd.n = (uint32_t)atoi(argv[3]);
    crowd.doors = calloc(crowd.n, sizeof(struct memory_door *));
    if (!crowd.doors || crowd.first + crowd.n > crowd.table->n) {
        fprintf(stderr, "fleet_crowd: the table has %u doors\n", crowd.table->n);
        return 4;
    }
    (void)signal(SIGPIPE, SIG_IGN);
    (void)sigemptyset(&ends);
    (void)sigaddset(&ends, SIGTERM);
    (void)sigprocmask(SIG_BLOCK, &ends, NULL);
    int r = sd_event_default(&crowd.event);
    r = r < 0 ? r : sd_event_add_signal(crowd.event, NULL, SIGTERM, NULL, NULL);
    if (r < 0 || iso_fleet_start(&fault) || link_http_new(crowd.event, &crowd.http, &fault)) {
        fail("start", r < 0 ? -r : EIO);
    }
    make_doors(&crowd, argv + 4);
    r = sd_event_add_time_relative(crowd.event, &step, CLOCK_MONOTONIC, STEP_US, 1000, on_step,
                                   &crowd);
    /* What the doors do is written down in time, however much they have to do. */
    r = r < 0 ? r : sd_event_source_set_priority(step, SD_EVENT_PRIORITY_IMPORTANT);
    r = r < 0 ? r : sd_event_loop(crowd.event);
    if (r < 0) {
        fail("the event loop", -r);
    }
    for (uint32_t i = 0; i < crowd.n; i++) {
        memory_door_free(crowd.doors[i]);
    }
    sd_event_source_unref(step);
    link_http_free(crowd.http);
    sd_event_unref(crowd.event);
    return 0;
}
