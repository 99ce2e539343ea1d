/* The link and a daemon that is away, is full, or lacks a key; how often it asks, and the requests
 * of a door. */
#include <string.h>

#include "tests/firmware/fleet/link/link_rig.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/programs/private_bus.h"

static void a_daemon_that_was_away_catches_up(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    rig->daemon.is_away = true;
    fake_hub_change(&rig->hub, zone);
    fake_hub_publish(&rig->hub, zone, 1);
    link_rig_until(rig, link_rig_report(rig).phase == LINK_AWAY);
    fake_hub_change(&rig->hub, zone);
    fake_hub_publish(&rig->hub, zone, 2);
    link_rig_run(rig, 200);
    rig->daemon.is_away = false;
    link_door_wake(rig->door);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 2);
}

/* Nobody says that it is back: the link asks. */
static void a_daemon_that_comes_back_is_found(void **state)
{
    struct link_rig *rig = *state;

    rig->daemon.is_away = true;
    (void)fake_hub_zone(&rig->hub, 0);
    link_rig_start(rig);
    link_rig_run(rig, 300);
    assert_int_equal(link_rig_report(rig).phase, LINK_AWAY);
    assert_int_equal(link_rig_report(rig).connections, 0);
    rig->daemon.is_away = false;
    link_rig_until_level(rig);
}

/* A fault of the disk ends neither the connection nor the lease, and the long file is not fetched
 * again and again. */
static void a_daemon_that_cannot_store_a_snapshot_keeps_its_lease(void **state)
{
    struct link_rig *rig = *state;

    (void)fake_hub_zone(&rig->hub, 5);
    rig->daemon.is_full = true;
    rig->daemon.requests = 1;
    link_rig_start(rig);
    link_rig_until(rig, rig->hub.fetches_of_snapshots == 2);
    assert_int_equal(link_rig_report(rig).phase, LINK_ONLINE);
    link_rig_run(rig, 3000);
    assert_int_equal(link_rig_report(rig).phase, LINK_ONLINE);
    assert_in_range(rig->hub.fetches_of_snapshots, 2, 12);
    assert_non_null(strstr(rig->notes, "the disk is full"));
    assert_non_null(strstr(rig->notes, "the list is too long"));
    rig->daemon.is_full = false;
    link_rig_until_level(rig);
}

static void a_missing_key_is_asked_for(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    rig->daemon.zones[0].has_key = false;
    rig->daemon.zones[0].place.epoch = 0; /* so that the hub sends the key again */
    fake_hub_change(&rig->hub, zone);
    fake_hub_publish(&rig->hub, zone, 1);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 1);
}

/* An answer counts only for the last question, so that there must not be a later one meanwhile. */
static void a_silent_hub_is_not_asked_again_and_again(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    link_rig_run(rig, 1100);
    rig->hub.is_silent = true;
    const uint64_t questions = rig->hub.questions;
    for (int i = 0; i < 30; i++) {
        fake_hub_change(&rig->hub, zone);
        fake_hub_publish(&rig->hub, zone, zone->n);
        link_rig_run(rig, 100);
    }
    assert_int_equal(rig->hub.questions, questions + 1);
}

/* With a lease of zero the link asks every five seconds, and not later. */
static void without_a_lease_the_link_asks_often(void **state)
{
    struct link_rig *rig = *state;

    rig->hub.lease_s = 0;
    (void)link_rig_begin(rig);
    link_rig_run(rig, 1100);
    const uint64_t questions = rig->hub.questions;
    link_rig_run(rig, 5200);
    assert_in_range(rig->hub.questions - questions, 1, 2);
}

static void requests_are_sent_in_rounds(void **state)
{
    struct link_rig *rig = *state;

    rig->daemon.requests = 100;
    rig->daemon.request_bytes = 40000; /* 4 MB together */
    (void)link_rig_begin(rig);
    link_rig_until(rig, rig->hub.requests == 100);
    link_rig_run(rig, 200);
    assert_int_equal(rig->hub.requests, 100);
    rig->daemon.requests = 2;
    link_door_work(rig->door, "requests");
    link_rig_until(rig, rig->hub.requests == 102);
}

/* While the hub is away, the broker says that nobody has heard a request. */
static void a_request_that_nobody_hears_is_sent_again(void **state)
{
    struct link_rig *rig = *state;

    (void)link_rig_begin(rig);
    const struct link_broker broker = {.host = "localhost", .port = rig->broker.port};
    const uint64_t sent = link_rig_report(rig).requests;
    fake_hub_stop(&rig->hub);
    rig->hub.mqtt = NULL;
    rig->daemon.requests = 1;
    rig->daemon.request_bytes = 100;
    link_door_work(rig->door, "requests");
    link_rig_until(rig, link_rig_report(rig).requests == sent + 1);
    link_rig_run(rig, 500);
    fake_hub_connect(&rig->hub, rig->event, &broker);
    link_rig_until(rig, rig->hub.requests == 1);
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, link_rig_setup, link_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(a_daemon_that_was_away_catches_up),
        RIG_TEST(a_daemon_that_comes_back_is_found),
        RIG_TEST(a_daemon_that_cannot_store_a_snapshot_keeps_its_lease),
        RIG_TEST(a_missing_key_is_asked_for),
        RIG_TEST(a_silent_hub_is_not_asked_again_and_again),
        RIG_TEST(without_a_lease_the_link_asks_often),
        RIG_TEST(requests_are_sent_in_rounds),
        RIG_TEST(a_request_that_nobody_hears_is_sent_again),
    };

    return mosquitto_rig_is_there() ? cmocka_run_group_tests(tests, NULL, NULL) : TEST_SKIPPED;
}
