/* The running hub, with a real database and a real broker, and a door that is played: it joins,
 * asks, follows its zone, sends events and fetches. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/answer/hub_event.h"
#include "enroll/hub/store/hub_door.h"
#include "enroll/hub/store/hub_zone.h"
#include "firmware/fleet/message/snapshot.h"
#include "tests/enroll/hub/rigs/served_door.h"
#include "tests/support/programs/prometheus_text.h"
#include "tests/support/scratch.h"

static void a_door_joins_and_gets_lease_and_key(void **state)
{
    static const uint8_t none[ISO_FLEET_KEY_BYTES];
    struct iso_fleet_lease lease;
    struct hub_door stored;
    struct iso_fault fault = {.text = ""};
    (void)state;

    served_door_begin();
    const char *code = hub_rig_add_door(&rig, "Gate");
    assert_int_equal(door_rig_join(&door, rig.hubs[0].port, "AAAABBBBCCCCDDDDEEEEFFFFGGGGHHHH"),
                     403);
    assert_int_equal(door_rig_join(&door, rig.hubs[0].port, code), 200);
    assert_memory_equal(door.membership.hub_signs, rig.store.keys.signs.public, 32);
    assert_string_equal(door.membership.door_name, "Gate");
    assert_int_equal(door.broker_port, rig.broker_port);
    /* The code is used up. */
    assert_int_equal(door_rig_join(&door, rig.hubs[0].port, code), 403);
    hub_rig_reload(&rig, door.id, true);
    assert_true(door_rig_connect(&door, &rig.zone));
    const double begun = served_now_s();
    assert_true(door_rig_ask(&door, "{\"door-state\":\"locked\"}", 0, &lease, 10));
    print_message("asked and answered in %.0f ms\n", 1e3 * (served_now_s() - begun));
    assert_int_equal(lease.n, 1);
    assert_true(iso_fleet_id_is_same(&lease.places[0].zone, &rig.zone));
    assert_int_equal(lease.lease_s, ISO_FLEET_LEASE_DEFAULT_S);
    assert_memory_not_equal(door.key.bytes, none, sizeof none);
    assert_int_equal(door.place.epoch, 1);
    served_ok(hub_door_find(&rig.store, "Gate", &stored, &fault), &fault);
    assert_string_equal(stored.health, "{\"door-state\":\"locked\"}");
    /* The broker tells the leader that the door is there, and Home Assistant how it is. */
    for (int i = 0; i < 500 && !stored.online; i++) {
        (void)usleep(20000);
        served_ok(hub_door_find(&rig.store, "Gate", &stored, &fault), &fault);
    }
    assert_true(stored.online);
}

static void a_change_arrives_within_a_second(void **state)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    struct iso_fleet_change change;
    struct iso_fleet_bytes plain = {.size = 0};
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    double longest = 0;
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    (void)iso_fleet_topic_delta(&rig.zone, topic);
    for (int i = 0; i < 10; i++) {
        const size_t from = door.client.n;
        served_ok(hub_zone_lockdown(&rig.store, &rig.zone, i % 2 == 0, &fault), &fault);
        const double begun = served_now_s();
        const int at = broker_client_wait(&door.client, topic, from, 5);
        assert_true(at >= 0);
        longest = served_now_s() - begun > longest ? served_now_s() - begun : longest;
        const struct broker_message *m = &door.client.messages[at];
        served_ok(iso_fleet_open_delta(m->bytes, m->size, &door.key, &plain), &fault);
        assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &change), 0);
        assert_int_equal(change.kind, ISO_FLEET_LOCKDOWN);
        assert_int_equal(change.lockdown, i % 2 == 0);
        iso_fleet_bytes_free(&plain);
        plain = (struct iso_fleet_bytes){.size = 0};
    }
    print_message("ten changes arrived; the slowest after %.0f ms\n", 1e3 * longest);
    assert_true(longest < 1);
    assert_int_equal(door_rig_follow(&door, 0), 0);
    assert_int_equal(door.place.sequence, 10);
}

/* The value of a measurement in the file of the hub. */
static double metric(const char *series)
{
    char *text = scratch_read_text(rig.hubs[0].metrics);
    const double value = prometheus_text_value(text, series);

    free(text);
    return value;
}

/* Sends `first` to `last`, a line for each, as one message. */
static void send_events(uint64_t first, uint64_t last, const char *lines)
{
    const struct iso_fleet_events events = {
        .door = door.membership.door, .first = first, .last = last};
    struct iso_fleet_bytes bytes = {.size = 0};
    char out[ISO_FLEET_TOPIC_SIZE];

    assert_int_equal(iso_fleet_make_events(&events, lines, strlen(lines),
                                           door.membership.hub_receives, &door.signs, &bytes),
                     0);
    assert_int_equal(mosquitto_publish(door.client.mosquitto, NULL,
                                       iso_fleet_topic_out(&door.membership.door, out),
                                       (int)bytes.size, bytes.bytes, 1, false),
                     0);
    iso_fleet_bytes_free(&bytes);
}

static size_t acks(size_t from)
{
    enum iso_fleet_kind kind;
    size_t n = 0;

    (void)pthread_mutex_lock(&door.client.lock);
    for (size_t i = from; i < door.client.n; i++) {
        const struct broker_message *m = &door.client.messages[i];
        n += iso_fleet_kind_of(m->bytes, m->size, &kind) == 0 && kind == ISO_FLEET_ACK;
    }
    (void)pthread_mutex_unlock(&door.client.lock);
    return n;
}

static void a_change_does_not_wait_for_many_messages(void **state)
{
    enum { MESSAGES = 1000 };
    static const char taken[] = "isotherm_hub_messages_total{kind=\"events\"}";
    char topic[ISO_FLEET_TOPIC_SIZE], line[100];
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    const size_t from = door.client.n;
    const double begun = served_now_s();
    for (unsigned i = 1; i <= MESSAGES; i++) {
        (void)snprintf(line, sizeof line,
                       "{\"sequence\":%u,\"time\":\"2026-11-21T08:30:15.250Z\",\"event\":"
                       "\"start\"}\n",
                       i);
        send_events(i, i, line);
    }
    served_ok(hub_zone_lockdown(&rig.store, &rig.zone, true, &fault), &fault);
    const double changed = served_now_s();
    (void)iso_fleet_topic_delta(&rig.zone, topic);
    assert_true(broker_client_wait(&door.client, topic, from, 10) >= 0);
    const double arrived = served_now_s();
    const size_t answered = acks(from);
    for (int i = 0; i < 3000 && acks(from) < MESSAGES; i++) {
        (void)usleep(10000);
    }
    assert_int_equal(acks(from), MESSAGES);
    print_message("%d messages answered in %.2f s; a change among them arrived after %.0f ms, "
                  "when %zu were answered\n",
                  MESSAGES, served_now_s() - begun, 1e3 * (arrived - changed), answered);
    assert_true(arrived - changed < 1);
    for (int i = 0; i < 2000 && metric(taken) < MESSAGES; i++) {
        (void)usleep(10000);
    }
    assert_true(metric(taken) >= MESSAGES);
    assert_true(metric("isotherm_hub_leader") == 1);
    assert_true(metric("isotherm_fleet_doors_joined") == 1);
    print_message("the longest call of the database within the loop took %.0f ms\n",
                  1e3 * metric("isotherm_hub_longest_call_seconds"));
}

static int count_event(void *context, const struct hub_event *event)
{
    (void)event;
    ++*(int *)context;
    return 0;
}

static uint64_t wait_for_ack(size_t from)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    struct iso_fleet_ack ack;

    (void)iso_fleet_topic_in(&door.membership.door, topic);
    for (int at = (int)from;; at++) {
        at = broker_client_wait(&door.client, topic, (size_t)at, 10);
        assert_true(at >= 0);
        const struct broker_message *m = &door.client.messages[at];
        if (iso_fleet_read_ack(m->bytes, m->size, door.membership.hub_signs, &ack) == 0) {
            return ack.number;
        }
    }
}

static void events_are_acknowledged_and_stored_once(void **state)
{
    static const char lines[] =
        "{\"sequence\":1,\"time\":\"2026-11-21T08:30:15.250Z\",\"event\":\"start\"}\n"
        "{\"sequence\":2,\"time\":\"2026-11-21T08:30:16.250Z\",\"event\":\"grant\",\"person\":"
        "\"A\"}\n";
    const struct hub_event_filter all = {.most = 0};
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    int n = 0;
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    for (int i = 0; i < 2; i++) {
        const size_t from = door.client.n;
        send_events(1, 2, lines);
        assert_int_equal(wait_for_ack(from), 2);
    }
    served_ok(hub_event_each(&rig.store, &all, count_event, &n, &fault), &fault);
    assert_int_equal(n, 2);
    assert_true(door_rig_ask(&door, "{}", 2, &lease, 10));
    assert_int_equal(lease.acked, 2);
}

/* ---- HTTPS ---- */

static void fetch(enum iso_fleet_wanted what, uint64_t after, struct door_reply *reply)
{
    struct iso_fleet_fetch wanted = {.door = door.membership.door,
                                     .zone = rig.zone,
                                     .time_s = time(NULL),
                                     .after = after,
                                     .what = what};
    struct iso_fleet_bytes bytes = {.size = 0};

    randombytes_buf(wanted.nonce, sizeof wanted.nonce);
    assert_int_equal(iso_fleet_make_fetch(&wanted, &door.signs, &bytes), 0);
    door_rig_post(&door, rig.hubs[0].port, "/fleet/v1/fetch", "application/octet-stream",
                  bytes.bytes, bytes.size, reply);
    iso_fleet_bytes_free(&bytes);
}

static void missing_deltas_and_snapshots_are_fetched(void **state)
{
    struct iso_fleet_delta delta;
    struct iso_fleet_place place;
    struct door_reply reply;
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    (void)state;

    served_door_begin();
    for (int i = 0; i < 5; i++) {
        served_ok(hub_zone_lockdown(&rig.store, &rig.zone, i % 2 == 0, &fault), &fault);
    }
    served_door_connect(&lease);
    assert_int_equal(lease.places[0].sequence, 5);
    fetch(ISO_FLEET_WANT_DELTAS, 2, &reply);
    assert_int_equal(reply.status, 200);
    size_t at = 0;
    for (uint64_t sequence = 3; sequence <= 5; sequence++) {
        const uint8_t *b = (const uint8_t *)reply.bytes + at;
        assert_true(at + 4 <= reply.size);
        const size_t n = b[0] | (size_t)b[1] << 8 | (size_t)b[2] << 16 | (size_t)b[3] << 24;
        assert_int_equal(iso_fleet_read_delta(b + 4, n, door.membership.hub_signs, &delta), 0);
        assert_int_equal(delta.place.sequence, sequence);
        at += 4 + n;
    }
    assert_int_equal(at, reply.size);
    free(reply.bytes);
    fetch(ISO_FLEET_WANT_DELTAS, 5, &reply);
    assert_int_equal(reply.status, 200);
    assert_int_equal(reply.size, 0);
    free(reply.bytes);
    fetch(ISO_FLEET_WANT_SNAPSHOT, 0, &reply);
    assert_int_equal(reply.status, 200);
    assert_int_equal(iso_fleet_snapshot_verify((const uint8_t *)reply.bytes, reply.size,
                                               door.membership.hub_signs, &place),
                     0);
    assert_int_equal(place.sequence, 5);
    free(reply.bytes);
    /* Somebody else has signed it. */
    assert_int_equal(crypto_sign_keypair(door.signs.public, door.signs.secret), 0);
    fetch(ISO_FLEET_WANT_DELTAS, 0, &reply);
    assert_int_equal(reply.status, 403);
    free(reply.bytes);
    door_rig_post(&door, rig.hubs[0].port, "/fleet/v1/fetch", "application/octet-stream", "xyz", 3,
                  &reply);
    assert_int_equal(reply.status, 400);
    free(reply.bytes);
}

static long renew(const char *name, char **certificate)
{
    struct door_reply reply;
    char *csr = scratch_read_text(scratch_path(door.folder, name));
    json_t *json = json_pack("{s:s}", "csr", csr);
    char *body = json_dumps(json, 0);

    door_rig_post(&door, rig.hubs[0].port, "/fleet/v1/renew", "application/json", body,
                  strlen(body), &reply);
    json_decref(json);
    if (reply.status == 200) {
        json = json_loads(reply.bytes, 0, NULL);
        *certificate = strdup(json_string_value(json_object_get(json, "certificate")));
        json_decref(json);
    }
    free(reply.bytes);
    free(body);
    free(csr);
    return reply.status;
}

static void a_certificate_is_renewed_for_its_key_alone(void **state)
{
    char line[512], *certificate = NULL;
    (void)state;

    served_door_begin();
    served_door_join();
    assert_int_equal(renew("door.csr", &certificate), 200);
    char *old = scratch_read_text(scratch_path(door.folder, "door.pem"));
    assert_string_not_equal(old, certificate);
    free(old);
    scratch_write_text(scratch_path(door.folder, "door.pem"), certificate);
    free(certificate);
    assert_true(door_rig_connect(&door, &rig.zone));
    (void)snprintf(line, sizeof line,
                   "cd %s && openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes "
                   "-keyout other.key -subj /CN=%s -out other.csr 2>/dev/null",
                   door.folder, door.id);
    assert_int_equal(system(line), 0);
    assert_int_equal(renew("other.csr", &certificate), 403);
}

static void an_expelled_door_gets_nothing_more(void **state)
{
    struct iso_fleet_lease lease;
    struct door_reply reply;
    struct iso_fault fault = {.text = ""};
    char *certificate;
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    served_ok(hub_door_expel(&rig.store, &door.membership.door, &fault), &fault);
    assert_false(door_rig_ask(&door, "{}", 0, &lease, 2));
    fetch(ISO_FLEET_WANT_DELTAS, 0, &reply);
    assert_int_equal(reply.status, 403);
    free(reply.bytes);
    assert_int_equal(renew("door.csr", &certificate), 403);
    hub_rig_reload(&rig, door.id, false);
    broker_client_end(&door.client);
    assert_false(door_rig_connect(&door, &rig.zone));
}

static void joining_is_tried_so_often_and_not_more(void **state)
{
    struct door_reply reply;
    int forbidden = 0, too_many = 0;
    (void)state;

    served_door_begin();
    for (int i = 0; i < 200 && too_many == 0; i++) {
        door_rig_post(&door, rig.hubs[0].port, "/fleet/v1/join", "application/json", "{}", 2,
                      &reply);
        forbidden += reply.status == 400;
        too_many += reply.status == 429;
        free(reply.bytes);
    }
    assert_true(forbidden >= 20);
    assert_int_equal(too_many, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        SERVED_TEST(a_door_joins_and_gets_lease_and_key),
        SERVED_TEST(a_change_arrives_within_a_second),
        SERVED_TEST(a_change_does_not_wait_for_many_messages),
        SERVED_TEST(events_are_acknowledged_and_stored_once),
        SERVED_TEST(missing_deltas_and_snapshots_are_fetched),
        SERVED_TEST(a_certificate_is_renewed_for_its_key_alone),
        SERVED_TEST(an_expelled_door_gets_nothing_more),
        SERVED_TEST(joining_is_tried_so_often_and_not_more),
    };
    return cmocka_run_group_tests(tests, NULL, hub_rig_end);
}
