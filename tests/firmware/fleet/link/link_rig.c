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

static struct link_broker broker_of(const struct link_rig *rig, const char *ca,
                                    const char *certificate, const char *key)
{
    struct link_broker broker = {.host = "127.0.0.1",
                                 .port = rig->broker.port,
                                 .backoff_base_ms = 50,
                                 .backoff_cap_ms = 400,
                                 .keepalive_s = 5};

    if (rig->is_secure) {
        broker.ca_file = scratch_path(rig->broker.directory, ca);
        broker.certificate_file = scratch_path(rig->broker.directory, certificate);
        broker.key_file = scratch_path(rig->broker.directory, key);
    }
    return broker;
}

static void write_client(struct link_rig *rig, const char *name)
{
    char key[4096], certificate[4096], file[64];
    const char *directory = rig->broker.directory;

    authority_client(&rig->authority, name, key, certificate);
    (void)snprintf(file, sizeof file, "%s.pem", name);
    scratch_write_text(scratch_path(directory, file), certificate);
    (void)snprintf(file, sizeof file, "%s-key.pem", name);
    scratch_write_text(scratch_path(directory, file), key);
}

static void start_servers(struct link_rig *rig, const char *directory)
{
    char key[4096], chain[8192];

    if (!rig->is_secure) {
        mosquitto_rig_start(&rig->broker, directory, false);
        fetch_server_start(&rig->hub.server, rig->event, NULL, NULL);
        return;
    }
    authority_make(&rig->authority);
    authority_server(&rig->authority, key, chain);
    scratch_write_text(scratch_path(directory, "ca.pem"), rig->authority.pem);
    scratch_write_text(scratch_path(directory, "server.pem"), chain);
    scratch_write_text(scratch_path(directory, "server-key.pem"), key);
    mosquitto_rig_start(&rig->broker, directory, true);
    write_client(rig, "hub");
    write_client(rig, "door");
    fetch_server_start(&rig->hub.server, rig->event, key, chain);
}

static int setup(void **state, bool is_secure)
{
    struct link_rig *rig = calloc(1, sizeof *rig);
    void *directory = NULL;
    struct iso_fault fault = {.text = ""};

    assert_non_null(rig);
    rig->is_secure = is_secure;
    assert_int_equal(iso_fleet_start(&fault), 0);
    assert_int_equal(scratch_setup(&directory), 0);
    assert_true(sd_event_new(&rig->event) >= 0);
    fake_hub_start(&rig->hub, rig->event, &rig->daemon);
    start_servers(rig, directory);
    free(directory);
    fake_daemon_init(&rig->daemon, rig->hub.signer.public, rig->hub.receiver.public);
    const struct link_broker broker = broker_of(rig, "ca.pem", "hub.pem", "hub-key.pem");
    fake_hub_connect(&rig->hub, rig->event, &broker);
    link_rig_until(rig, rig->hub.subscriptions == 1);
    assert_int_equal(link_http_new(rig->event, &rig->http, &fault), 0);
    *state = rig;
    return 0;
}

int link_rig_setup(void **state)
{
    return setup(state, false);
}

int link_rig_setup_secure(void **state)
{
    return setup(state, true);
}

void link_rig_start_with(struct link_rig *rig, const char *ca, const char *certificate,
                         const char *key)
{
    struct iso_fault fault = {.text = ""};
    const struct link_setup with = {.event = rig->event,
                                    .daemon = fake_daemon_calls(&rig->daemon),
                                    .http = rig->http,
                                    .broker = broker_of(rig, ca, certificate, key),
                                    .hub_url = rig->hub.server.url,
                                    .folder = rig->is_secure ? rig->broker.directory : NULL,
                                    .note = on_note,
                                    .note_context = rig};

    assert_int_equal(link_door_new(&with, &rig->door, &fault), 0);
}

void link_rig_start(struct link_rig *rig)
{
    link_rig_start_with(rig, "ca.pem", "door.pem", "door-key.pem");
}

int link_rig_teardown(void **state)
{
    struct link_rig *rig = *state;
    void *directory = strdup(rig->broker.directory);

    link_door_free(rig->door);
    link_http_free(rig->http);
    fake_hub_stop(&rig->hub);
    if (rig->is_secure) {
        authority_free(&rig->authority);
    }
    mosquitto_rig_kill(&rig->broker);
    (void)sd_event_unref(rig->event);
    free(rig);
    return scratch_teardown(&directory);
}

struct hub_zone *link_rig_begin(struct link_rig *rig)
{
    struct hub_zone *zone = fake_hub_zone(&rig->hub, 0);

    link_rig_start(rig);
    link_rig_until_level(rig);
    link_rig_until(rig, link_rig_report(rig).phase == LINK_ONLINE);
    return zone;
}
