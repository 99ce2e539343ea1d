/* The link between a hub and a daemon over a real broker: what reaches the daemon, in which order,
 * and what is fetched. */
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/head.h"
#include "tests/firmware/fleet/link/link_rig.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/programs/private_bus.h"

static void changes_arrive_and_are_confirmed(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    for (int i = 0; i < 20; i++) {
        fake_hub_change(&rig->hub, zone);
        fake_hub_publish(&rig->hub, zone, zone->n);
    }
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 20);
    assert_int_equal(rig->hub.server.requests, 0);
    assert_string_equal(rig->hub.online, "1");
    /* Twenty changes at once are confirmed by few questions, at least a second apart. */
    assert_true(rig->hub.questions <= 6);
}

/* The hub publishes a change after it has got the question and before it answers; the answer does
 * not name it. Only a door that has subscribed before it asked gets it. */
static void nothing_falls_between_subscription_and_comparison(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    link_door_free(rig->door);
    rig->hub.publishes_on_question = true;
    link_rig_start(rig);
    link_rig_until(rig, zone->n == 1);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 1);
    assert_int_equal(rig->hub.server.requests, 0);
}

static void a_gap_is_fetched(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    for (int i = 0; i < 40; i++) {
        fake_hub_change(&rig->hub, zone);
    }
    fake_hub_publish(&rig->hub, zone, 40);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 40);
    assert_int_equal(rig->hub.fetches_of_deltas, 1);
    assert_int_equal(link_rig_report(rig).refused, 0);
}

/* The broker keeps a HEAD for a door that was away; the hub has more deltas than one reply holds.
 */
static void a_head_leads_to_fetches_until_level(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    rig->hub.reply_most = 15;
    for (int i = 0; i < 40; i++) {
        fake_hub_change(&rig->hub, zone);
    }
    fake_hub_publish_head(&rig->hub, zone);
    link_rig_until_level(rig);
    assert_int_equal(rig->hub.fetches_of_deltas, 3);
}

static void deltas_during_a_fetch_are_not_lost(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    rig->hub.server.holds = true;
    for (int i = 0; i < 3; i++) {
        fake_hub_change(&rig->hub, zone);
    }
    fake_hub_publish(&rig->hub, zone, 3);
    link_rig_until(rig, rig->hub.server.held);
    /* The reply, which is ready, ends with delta 3. Delta 4 is lost, delta 5 arrives. */
    fake_hub_change(&rig->hub, zone);
    fake_hub_change(&rig->hub, zone);
    const uint64_t received = rig->daemon.received;
    fake_hub_publish(&rig->hub, zone, 5);
    link_rig_until(rig, rig->daemon.received > received);
    assert_int_equal(rig->hub.fetches_of_deltas, 1);
    fetch_server_release(&rig->hub.server);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 5);
    assert_int_equal(rig->hub.fetches_of_deltas, 2);
}

static void a_new_door_gets_a_snapshot(void **state)
{
    struct link_rig *rig = *state;

    (void)fake_hub_zone(&rig->hub, 30);
    link_rig_start(rig);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.snapshots, 1);
    assert_int_equal(rig->daemon.snapshot_people, 30);
    assert_int_equal(link_rig_report(rig).snapshots, 1);
    assert_int_equal(rig->daemon.applied, 0);
}

static void deltas_that_are_gone_are_replaced_by_a_snapshot(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    rig->hub.has_no_deltas = true;
    for (int i = 0; i < 5; i++) {
        fake_hub_change(&rig->hub, zone);
    }
    fake_hub_publish(&rig->hub, zone, 5);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.snapshots, 1);
}

/* A zone that the door gets later: its topics are subscribed before the next question, which tells
 * what was missed. */
static void a_further_zone_is_subscribed(void **state)
{
    struct link_rig *rig = *state;

    (void)link_rig_begin(rig);
    struct hub_zone *second = fake_hub_zone(&rig->hub, 2);
    link_door_work(rig->door, "places");
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.snapshots, 1);
    link_rig_until(rig, link_rig_report(rig).phase == LINK_ONLINE);
    fake_hub_change(&rig->hub, second);
    fake_hub_publish(&rig->hub, second, 3);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 1);
}

/* After the door has left a zone, the broker sends it nothing of it. */
static void a_lost_zone_is_unsubscribed(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *first = link_rig_begin(rig);
    struct hub_zone *second = fake_hub_zone(&rig->hub, 0);

    link_door_work(rig->door, "places");
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.n, 2);
    rig->hub.zone_count = 1;
    link_door_work(rig->door, "places");
    link_rig_until(rig, rig->daemon.n == 1);
    link_rig_run(rig, 300); /* until the broker has the end of the subscription */
    fake_hub_change(&rig->hub, second);
    fake_hub_publish(&rig->hub, second, 1);
    fake_hub_change(&rig->hub, first);
    fake_hub_publish(&rig->hub, first, 1);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 1);
    assert_int_equal(link_rig_report(rig).forged, 0);
    rig->hub.zone_count = 2;
}

/* ---- messages that must not reach the daemon ---- */

static void send_to_zone(struct link_rig *rig, bool head, const struct iso_fleet_id *zone,
                         const struct iso_fleet_bytes *bytes)
{
    char topic[ISO_FLEET_TOPIC_SIZE];

    fake_hub_send(&rig->hub,
                  head ? iso_fleet_topic_head(zone, topic) : iso_fleet_topic_delta(zone, topic),
                  bytes->bytes, bytes->size);
}

static void send_to_door(struct link_rig *rig, const struct iso_fleet_bytes *bytes)
{
    char topic[ISO_FLEET_TOPIC_SIZE];

    fake_hub_send(&rig->hub, iso_fleet_topic_in(&rig->daemon.door, topic), bytes->bytes,
                  bytes->size);
}

static void send_foreign(struct link_rig *rig, const struct iso_fleet_signer *signer,
                         const struct iso_fleet_id *door)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    const struct iso_fleet_ack ack = {.door = *door, .number = 1000};

    assert_int_equal(iso_fleet_make_ack(&ack, signer, &bytes), 0);
    send_to_door(rig, &bytes);
    iso_fleet_bytes_free(&bytes);
}

static void forged_messages_do_not_reach_the_daemon(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);
    struct iso_fleet_signer stranger;
    const struct iso_fleet_id other = iso_fleet_id_random();
    uint64_t sent = 0;

    assert_int_equal(crypto_sign_keypair(stranger.public, stranger.secret), 0);
    fake_hub_change(&rig->hub, zone);
    struct iso_fleet_bytes *delta = &zone->deltas[0];
    const uint64_t received = rig->daemon.received;
    /* a delta with one changed byte, at many places */
    for (size_t i = 0; i < delta->size; i += 7) {
        delta->bytes[i] ^= 0x40;
        send_to_zone(rig, false, &zone->place.zone, delta);
        delta->bytes[i] ^= 0x40;
        sent++;
    }
    /* a good delta in the wrong places */
    send_to_zone(rig, true, &zone->place.zone, delta);
    send_to_door(rig, delta);
    /* messages of a stranger, and of the hub for another door */
    send_foreign(rig, &stranger, &rig->daemon.door);
    send_foreign(rig, &rig->hub.signer, &other);
    /* no message at all */
    send_to_door(rig, &(struct iso_fleet_bytes){.bytes = (uint8_t[]){'x'}, .size = 1});
    send_to_zone(rig, false, &zone->place.zone,
                 &(struct iso_fleet_bytes){.bytes = (uint8_t *)(uintptr_t) "ISOF", .size = 4});
    sent += 6;
    link_rig_until(rig, link_rig_report(rig).forged == sent);
    assert_int_equal(rig->daemon.received, received);
    assert_int_equal(rig->daemon.acked, 0);
    /* The unchanged delta is taken. */
    send_to_zone(rig, false, &zone->place.zone, delta);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 1);
}

static void forged_replies_do_not_reach_the_daemon(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);

    rig->hub.forges_reply = true;
    fake_hub_change(&rig->hub, zone);
    fake_hub_publish_head(&rig->hub, zone);
    link_rig_until(rig, link_rig_report(rig).forged >= 1);
    assert_int_equal(rig->daemon.applied, 0);
    assert_int_equal(link_rig_report(rig).failed_fetches, 1);
    rig->daemon.zones[0].wants_snapshot = true;
    link_door_wake(rig->door);
    link_rig_until(rig, link_rig_report(rig).forged >= 2 && rig->hub.fetches_of_snapshots);
    assert_int_equal(rig->daemon.snapshots, 0);
    rig->hub.forges_reply = false;
    link_rig_until_level(rig);
}

/* Makes a message one of the next version, signed by the hub or by a stranger. */
static void make_newer(struct iso_fleet_bytes *bytes, const struct iso_fleet_signer *signer)
{
    bytes->bytes[4] = ISO_FLEET_VERSION + 1;
    bytes->size -= ISO_FLEET_SIGNATURE_BYTES;
    assert_int_equal(iso_fleet_sign(bytes, signer), 0);
}

/* The daemon refuses what it cannot read, and nothing is skipped: what comes after it waits. */
static void a_newer_hub_is_named_and_nothing_is_lost(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = link_rig_begin(rig);
    struct iso_fleet_signer stranger;
    struct iso_fleet_bytes newer = {.bytes = NULL};

    assert_int_equal(crypto_sign_keypair(stranger.public, stranger.secret), 0);
    fake_hub_change(&rig->hub, zone);
    struct iso_fleet_bytes *delta = &zone->deltas[0];
    iso_fleet_put(&newer, delta->bytes, delta->size);
    make_newer(&newer, &stranger);
    send_to_zone(rig, false, &zone->place.zone, &newer);
    link_rig_until(rig, link_rig_report(rig).forged == 1);
    assert_null(strstr(rig->notes, "newer version"));
    make_newer(&newer, &rig->hub.signer);
    send_to_zone(rig, false, &zone->place.zone, &newer);
    link_rig_until(rig, rig->daemon.refused == 1);
    assert_non_null(strstr(rig->notes, "the hub sends messages of a newer version"));
    assert_int_equal(link_rig_report(rig).forged, 1);
    assert_int_equal(rig->daemon.applied, 0);
    /* The hub has only this to fetch, too. */
    struct iso_fleet_bytes old = *delta;
    *delta = newer;
    fake_hub_publish_head(&rig->hub, zone);
    link_rig_until(rig, rig->daemon.refused >= 2 && link_rig_report(rig).failed_fetches >= 1);
    assert_int_equal(rig->daemon.zones[0].place.sequence, 0);
    assert_true(link_rig_report(rig).phase == LINK_ONLINE);
    /* A program that can read it goes on where this one stays. */
    *delta = old;
    iso_fleet_bytes_free(&newer);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 1);
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, link_rig_setup, link_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(changes_arrive_and_are_confirmed),
        RIG_TEST(nothing_falls_between_subscription_and_comparison),
        RIG_TEST(a_gap_is_fetched),
        RIG_TEST(a_head_leads_to_fetches_until_level),
        RIG_TEST(deltas_during_a_fetch_are_not_lost),
        RIG_TEST(a_new_door_gets_a_snapshot),
        RIG_TEST(deltas_that_are_gone_are_replaced_by_a_snapshot),
        RIG_TEST(a_further_zone_is_subscribed),
        RIG_TEST(a_lost_zone_is_unsubscribed),
        RIG_TEST(forged_messages_do_not_reach_the_daemon),
        RIG_TEST(forged_replies_do_not_reach_the_daemon),
        RIG_TEST(a_newer_hub_is_named_and_nothing_is_lost),
    };

    return mosquitto_rig_is_there() ? cmocka_run_group_tests(tests, NULL, NULL) : TEST_SKIPPED;
}
