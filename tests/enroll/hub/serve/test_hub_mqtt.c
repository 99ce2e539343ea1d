/* The hub's connection to the broker, with a real mosquitto: bursts in both directions, waiting for
 * acknowledgements, and a broker that goes and comes again. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/broker/hub_pair.h"
#include "enroll/hub/serve/mqtt.h"
#include "firmware/fleet/message/envelope.h"
#include "tests/enroll/hub/rigs/broker_rig.h"
#include "tests/support/scratch.h"

enum { BURST = 3000 };

static struct {
    const char *folder;
    struct broker_rig broker;
    uint16_t port;
    sd_event *event;
    struct hub_mqtt *mqtt;
    struct broker_client peer;
    int states, losses, acknowledged;
    size_t n, in_order;
} rig;

static void on_state(void *context, bool is_connected)
{
    assert_ptr_equal(context, &rig);
    rig.states += is_connected;
    rig.losses += !is_connected;
    if (is_connected) {
        assert_int_equal(hub_mqtt_subscribe(rig.mqtt, "to/hub"), 0);
    }
}

static void on_message(void *context, const char *topic, const void *bytes, size_t size)
{
    char text[32];

    assert_ptr_equal(context, &rig);
    assert_string_equal(topic, "to/hub");
    assert_true(size < sizeof text);
    memcpy(text, bytes, size);
    text[size] = '\0';
    rig.in_order += (size_t)atoi(text) == rig.n;
    rig.n++;
    errno = EAGAIN; /* a handler may leave it behind */
}

static void on_acknowledged(void *context)
{
    assert_ptr_equal(context, &rig);
    rig.acknowledged++;
}

static double now_s(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Runs the loop until a number has reached a value, for some seconds. */
static void run_until(const int *what, int value)
{
    const double end = now_s() + 20;

    while (*what < value && now_s() < end) {
        assert_true(sd_event_run(rig.event, 50000) >= 0);
    }
    assert_true(*what >= value);
}

static void start_broker(bool is_tls)
{
    char config[1024];
    const char *f = rig.folder;
    int n = snprintf(config, sizeof config,
                     "persistence false\nallow_anonymous true\nmax_inflight_messages 1000\n"
                     "max_queued_messages 20000\n%slistener %u 127.0.0.1\n",
                     geteuid() == 0 ? "user root\n" : "", rig.port);
    if (is_tls) {
        (void)snprintf(config + n, sizeof config - (size_t)n,
                       "cafile %s/ca.pem\ncertfile %s/broker.pem\nkeyfile %s/broker-key.pem\n"
                       "require_certificate true\n",
                       f, f, f);
    }
    scratch_write_text(scratch_path(f, "mosquitto.conf"), config);
    broker_rig_start(&rig.broker, scratch_path(f, "mosquitto.conf"), rig.port,
                     scratch_path(f, "log"));
}

static void start(void **state, bool is_tls)
{
    static const char *const hosts[] = {"127.0.0.1"};
    struct hub_ca *ca = NULL;
    struct hub_pair pair;
    struct iso_fault fault = {.text = ""};

    memset(&rig, 0, sizeof rig);
    assert_int_equal(iso_fleet_start(&fault), 0);
    assert_int_equal(scratch_setup(state), 0);
    rig.folder = *state;
    rig.port = broker_rig_port();
    assert_int_equal(sd_event_new(&rig.event), 0);
    assert_int_equal(hub_ca_open(rig.folder, &ca, &fault), 0);
    for (int use = HUB_PAIR_BROKER; use <= HUB_PAIR_CLIENT; use++) {
        assert_int_equal(hub_pair_open(ca, rig.folder, use, hosts, 1, time(NULL), &pair, &fault),
                         0);
        hub_pair_free(&pair);
    }
    hub_ca_free(ca);
    struct hub_mqtt_setup setup = {.event = rig.event,
                                   .id = "hub",
                                   .host = "127.0.0.1",
                                   .port = rig.port,
                                   .on_state = on_state,
                                   .on_message = on_message,
                                   .on_acknowledged = on_acknowledged,
                                   .context = &rig};
    if (is_tls) {
        setup.ca = scratch_path(rig.folder, "ca.pem");
        setup.certificate = scratch_path(rig.folder, "hub-client.pem");
        setup.key = scratch_path(rig.folder, "hub-client-key.pem");
    }
    assert_int_equal(hub_mqtt_new(&setup, &rig.mqtt, &fault), 0);
    start_broker(is_tls);
    run_until(&rig.states, 1);
    assert_true(hub_mqtt_is_connected(rig.mqtt));
    broker_client_begin(&rig.peer, "peer", rig.port, setup.ca, setup.certificate, setup.key);
    assert_true(broker_client_connects(&rig.peer));
}

static int setup_plain(void **state)
{
    start(state, false);
    return 0;
}

static int setup_tls(void **state)
{
    start(state, true);
    return 0;
}

static int teardown(void **state)
{
    broker_client_end(&rig.peer);
    hub_mqtt_free(rig.mqtt);
    sd_event_unref(rig.event);
    broker_rig_stop(&rig.broker);
    return scratch_teardown(state);
}

/* Everything arrives, in order, and the loop does not wait for a timer between two packets. */
static void a_burst_arrives(void **state)
{
    const double begun = now_s();
    (void)state;

    for (int i = 0; i < BURST; i++) {
        char text[32];
        (void)snprintf(text, sizeof text, "%d", i);
        assert_int_equal(mosquitto_publish(rig.peer.mosquitto, NULL, "to/hub", (int)strlen(text),
                                           text, 1, false),
                         0);
    }
    while (rig.n < BURST && now_s() < begun + 30) {
        assert_true(sd_event_run(rig.event, 50000) >= 0);
    }
    assert_int_equal(rig.n, BURST);
    assert_int_equal(rig.in_order, BURST);
    print_message("%d messages received in %.2f s\n", BURST, now_s() - begun);
}

static void a_burst_is_acknowledged(void **state)
{
    struct hub_mqtt_counts counts;
    const double begun = now_s();
    (void)state;

    broker_client_subscribe(&rig.peer, "from/hub");
    for (int i = 0; i < BURST; i++) {
        assert_int_equal(hub_mqtt_publish(rig.mqtt, "from/hub", &i, sizeof i, false), 0);
    }
    run_until(&rig.acknowledged, BURST);
    print_message("%d messages acknowledged in %.2f s\n", BURST, now_s() - begun);
    hub_mqtt_counts(rig.mqtt, &counts);
    assert_int_equal(counts.acknowledged, BURST);
    while (rig.peer.n < BURST && now_s() < begun + 30) {
        (void)usleep(10000);
    }
    assert_int_equal(rig.peer.n, BURST);
    for (int i = 0; i < BURST; i++) {
        assert_memory_equal(rig.peer.messages[i].bytes, &i, sizeof i);
    }
}

/* What a broker that dies has not acknowledged is sent again, and counts then. */
static void what_is_not_acknowledged_is_sent_again(void **state)
{
    struct hub_mqtt_counts counts;
    (void)state;

    assert_int_equal(kill(rig.broker.pid, SIGSTOP), 0);
    for (int i = 0; i < 100; i++) {
        assert_int_equal(hub_mqtt_publish(rig.mqtt, "from/hub", &i, sizeof i, false), 0);
    }
    assert_true(sd_event_run(rig.event, 50000) >= 0);
    assert_int_equal(rig.acknowledged, 0);
    broker_client_end(&rig.peer);
    broker_rig_stop(&rig.broker);
    run_until(&rig.losses, 1);
    start_broker(false);
    run_until(&rig.acknowledged, 100);
    hub_mqtt_counts(rig.mqtt, &counts);
    assert_int_equal(counts.published, 100);
    assert_int_equal(counts.acknowledged, 100);
    broker_client_begin(&rig.peer, "peer", rig.port, NULL, NULL, NULL);
}

static void a_broker_that_dies_is_found_again(void **state)
{
    (void)state;

    broker_client_end(&rig.peer);
    broker_rig_stop(&rig.broker);
    run_until(&rig.losses, 1);
    assert_false(hub_mqtt_is_connected(rig.mqtt));
    assert_int_equal(hub_mqtt_publish(rig.mqtt, "from/hub", "x", 1, false), -ENOTCONN);
    start_broker(true);
    run_until(&rig.states, 2);
    broker_client_begin(&rig.peer, "peer", rig.port, scratch_path(rig.folder, "ca.pem"),
                        scratch_path(rig.folder, "hub-client.pem"),
                        scratch_path(rig.folder, "hub-client-key.pem"));
    assert_true(broker_client_connects(&rig.peer));
    broker_client_subscribe(&rig.peer, "from/hub");
    assert_int_equal(hub_mqtt_publish(rig.mqtt, "from/hub", "again", 5, false), 0);
    run_until(&rig.acknowledged, 1);
    assert_true(broker_client_wait(&rig.peer, "from/hub", 0, 10) >= 0);
    assert_int_equal(hub_mqtt_subscribe(rig.mqtt, "to/hub"), 0);
}

/* A connection that is refused has failed at once. One that counted as being made until it is given
 * up, after 10 s, would make three attempts in 21 s. */
static void a_refused_connection_is_tried_again(void **state)
{
    struct hub_mqtt_counts counts = {.attempts = 0};
    const double end = now_s() + 20;
    (void)state;

    broker_rig_stop(&rig.broker);
    run_until(&rig.losses, 1);
    hub_mqtt_counts(rig.mqtt, &counts);
    const uint64_t before = counts.attempts;
    while (counts.attempts < before + 3 && now_s() < end) {
        assert_true(sd_event_run(rig.event, 50000) >= 0);
        hub_mqtt_counts(rig.mqtt, &counts);
    }
    assert_true(counts.attempts >= before + 3);
    start_broker(true);
    run_until(&rig.states, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_burst_arrives, setup_plain, teardown),
        cmocka_unit_test_setup_teardown(a_burst_arrives, setup_tls, teardown),
        cmocka_unit_test_setup_teardown(a_burst_is_acknowledged, setup_plain, teardown),
        cmocka_unit_test_setup_teardown(a_burst_is_acknowledged, setup_tls, teardown),
        cmocka_unit_test_setup_teardown(what_is_not_acknowledged_is_sent_again, setup_plain,
                                        teardown),
        cmocka_unit_test_setup_teardown(a_refused_connection_is_tried_again, setup_tls, teardown),
        cmocka_unit_test_setup_teardown(a_broker_that_dies_is_found_again, setup_tls, teardown),
    };
    return broker_rig_is_possible() ? cmocka_run_group_tests(tests, NULL, NULL) : 77;
}
