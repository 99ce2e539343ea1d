#include "tests/firmware/fleet/link/link_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/scratch.h"

int64_t link_rig_now_ms(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

void link_rig_turn(struct link_rig *rig)
{
    assert_true(sd_event_run(rig->event, 20000) >= 0);
}

void link_rig_run(struct link_rig *rig, int ms)
{
    const int64_t end = link_rig_now_ms() + ms;

    while (link_rig_now_ms() < end) {
        link_rig_turn(rig);
    }
}

static bool is_level(const struct link_rig *rig)
{
    if (rig->daemon.n != rig->hub.zone_count) {
        return false;
    }
    for (size_t i = 0; i < rig->hub.zone_count; i++) {
        const struct iso_fleet_place *there = &rig->hub.zones[i].place;
        bool is_same = false;
        for (size_t k = 0; k < rig->daemon.n; k++) {
            is_same = is_same || memcmp(there, &rig->daemon.zones[k].place, sizeof *there) == 0;
        }
        if (!is_same) {
            return false;
        }
    }
    return rig->hub.zone_count == 0 ||
           rig->hub.last_question.sequence == rig->daemon.zones[0].place.sequence;
}

void link_rig_until_level(struct link_rig *rig)
{
    link_rig_until(rig, is_level(rig));
}

static void on_note(void *context, const char *line)
{
    struct link_rig *rig = context;
    const size_t used = strlen(rig->notes);

    (void)snprintf(rig->notes + used, sizeof rig->notes - used, "%s\n", line);
}

static struct link_broker broker_of(const struct link_rig *rig)
{
    return (struct link_broker){.host = "127.0.0.1",
                                .port = rig->broker.port,
                                .backoff_base_ms = 50,
                                .backoff_cap_ms = 400,
                                .keepalive_s = 5};
}

int link_rig_setup(void **state)
{
    struct link_rig *rig = calloc(1, sizeof *rig);
    void *directory = NULL;
    struct iso_fault fault = {.text = ""};

    assert_non_null(rig);
    assert_int_equal(iso_fleet_start(&fault), 0);
    assert_int_equal(scratch_setup(&directory), 0);
    assert_true(sd_event_new(&rig->event) >= 0);
    mosquitto_rig_start(&rig->broker, directory, false);
    free(directory);
    fake_hub_start(&rig->hub, rig->event, &rig->daemon);
    fake_daemon_init(&rig->daemon, rig->hub.signer.public, rig->hub.receiver.public);
    fetch_server_start(&rig->hub.server, rig->event, NULL, NULL);
    const struct link_broker broker = broker_of(rig);
    fake_hub_connect(&rig->hub, rig->event, &broker);
    link_rig_until(rig, rig->hub.subscriptions == 1);
    assert_int_equal(link_http_new(rig->event, &rig->http, &fault), 0);
    *state = rig;
    return 0;
}

void link_rig_start(struct link_rig *rig)
{
    struct iso_fault fault = {.text = ""};
    const struct link_setup setup = {.event = rig->event,
                                     .daemon = fake_daemon_calls(&rig->daemon),
                                     .http = rig->http,
                                     .broker = broker_of(rig),
                                     .hub_url = rig->hub.server.url,
                                     .note = on_note,
                                     .note_context = rig};

    assert_int_equal(link_door_new(&setup, &rig->door, &fault), 0);
}

int link_rig_teardown(void **state)
{
    struct link_rig *rig = *state;
    void *directory = strdup(rig->broker.directory);

    link_door_free(rig->door);
    link_http_free(rig->http);
    fake_hub_stop(&rig->hub);
    mosquitto_rig_kill(&rig->broker);
    (void)sd_event_unref(rig->event);
    free(rig);
    return scratch_teardown(&directory);
}
