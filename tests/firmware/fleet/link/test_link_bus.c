/* The daemon over a real bus, in another process: every method, a daemon that is killed and
 * started again, a bus that is, and the link with both. */
#include "firmware/fleet/link/link_bus.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "firmware/fleet/message/zone_key.h"
#include "tests/firmware/fleet/link/bus_service.h"
#include "tests/firmware/fleet/link/link_rig.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/programs/private_bus.h"

static struct private_bus bus;

struct told {
    struct link_rig *rig;
    struct link_bus *client;
    struct iso_link_daemon daemon;
    pid_t service;
    unsigned came, events;
};

static void on_came(void *context)
{
    struct told *told = context;

    told->came++;
    if (told->rig->door) {
        link_door_wake(told->rig->door);
    }
}

static void on_work(void *context, const char *what)
{
    struct told *told = context;

    told->events += strcmp(what, "events") == 0;
}

static int setup(void **state)
{
    static struct told told;
    struct iso_fault fault = {.text = ""};
    const struct link_bus_calls calls = {.context = &told, .came = on_came, .work = on_work};
    void *rig = NULL;

    assert_int_equal(link_rig_setup(&rig), 0);
    told = (struct told){.rig = rig};
    assert_int_equal(link_bus_new(told.rig->event, bus.address, &calls, &told.client, &fault), 0);
    told.daemon = link_bus_daemon(told.client);
    *state = &told;
    return 0;
}

static int teardown(void **state)
{
    struct told *told = *state;
    void *rig = told->rig;

    link_door_free(told->rig->door);
    told->rig->door = NULL;
    link_bus_free(told->client);
    if (told->service) {
        bus_service_stop(told->service);
    }
    return link_rig_teardown(&rig);
}

static int status_of(struct told *told)
{
    struct iso_link_status status;
    struct iso_fault fault = {.text = ""};

    return told->daemon.status(told->daemon.context, &status, &fault);
}

/* Starts the service and waits until it answers. */
static void start(struct told *told, bool is_member)
{
    told->service = bus_service_start(bus.address, &told->rig->daemon, is_member);
    link_rig_until(told->rig, status_of(told) != -ENOTCONN);
}

static void the_state_is_read(void **state)
{
    struct told *told = *state;
    struct fake_daemon *daemon = &told->rig->daemon;
    struct iso_link_status status;
    struct link_bus_lease lease;
    struct iso_fault fault = {.text = ""};

    daemon->last_event = 70;
    daemon->acked = 20;
    daemon->lease_s = 600;
    daemon->n = 2;
    for (size_t i = 0; i < 2; i++) {
        daemon->zones[i].place = (struct iso_fleet_place){
            .zone = iso_fleet_id_random(), .epoch = 3 + i, .sequence = 1000 + i};
        randombytes_buf(daemon->zones[i].place.digest, 32);
    }
    daemon->zones[1].wants_snapshot = true;
    start(told, true);
    assert_int_equal(link_bus_status(told->client, &status, &lease, &fault), 0);
    assert_memory_equal(&status.door, &daemon->door, sizeof status.door);
    assert_memory_equal(status.hub_signs, daemon->hub_signs, sizeof status.hub_signs);
    assert_int_equal(status.last_event, 70);
    assert_int_equal(status.acked, 20);
    assert_int_equal(status.lease_s, 600);
    assert_int_equal(status.n, 2);
    for (size_t i = 0; i < 2; i++) {
        assert_memory_equal(&status.places[i], &daemon->zones[i].place, sizeof status.places[i]);
    }
    assert_false(status.wants_snapshot[0]);
    assert_true(status.wants_snapshot[1]);
    assert_string_equal(lease.word, "held");
    assert_int_equal(lease.left_s, 1234);
    assert_int_equal(lease.pending, 3);
    assert_true(lease.is_hub_behind);
    assert_string_equal(lease.fault, "the policy is too large");
    assert_string_equal(lease.door_name, "East");
    assert_string_equal(lease.hub_name, "Works");
}

static void a_daemon_without_a_fleet_is_told_from_one_that_is_away(void **state)
{
    struct told *told = *state;
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_bytes bytes = {.bytes = NULL};

    assert_int_equal(status_of(told), -ENOTCONN);
    assert_int_equal(told->daemon.question(told->daemon.context, &bytes, &fault), -ENOTCONN);
    assert_null(bytes.bytes);
    start(told, false);
    assert_int_equal(status_of(told), -ENOENT);
}

static void messages_pass_through_the_bus(void **state)
{
    struct told *told = *state;
    const struct fake_daemon *door = &told->rig->daemon;
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct iso_fleet_question question;
    struct iso_fleet_events events;
    struct iso_fleet_bytes lines = {.bytes = NULL};
    struct iso_fault fault = {.text = ""};
    uint64_t last = 0;

    told->rig->daemon.last_event = 70;
    start(told, true);
    assert_int_equal(told->daemon.question(told->daemon.context, &bytes, &fault), 0);
    assert_int_equal(
        iso_fleet_read_question(bytes.bytes, bytes.size, door->signer.public, &question), 0);
    iso_fleet_bytes_free(&bytes);
    link_rig_until(told->rig, told->events == 1);
    assert_int_equal(told->daemon.events(told->daemon.context, 5, 10, &bytes, &last, &fault), 0);
    assert_int_equal(last, 15);
    assert_int_equal(iso_fleet_read_events(bytes.bytes, bytes.size, door->signer.public,
                                           &told->rig->hub.receiver, &events, &lines),
                     0);
    assert_int_equal(events.first, 6);
    iso_fleet_bytes_free(&lines);
    iso_fleet_bytes_free(&bytes);
    assert_int_equal(told->daemon.events(told->daemon.context, 70, 10, &bytes, &last, &fault), 0);
    assert_int_equal(last, 0);
    assert_int_equal(bytes.size, 0);
}

static void start_link(struct told *told)
{
    struct iso_fault fault = {.text = ""};
    const struct link_setup with = {.event = told->rig->event,
                                    .daemon = told->daemon,
                                    .http = told->rig->http,
                                    .broker = {.host = "127.0.0.1",
                                               .port = told->rig->broker.port,
                                               .backoff_base_ms = 50,
                                               .backoff_cap_ms = 400},
                                    .hub_url = told->rig->hub.server.url};

    assert_int_equal(link_door_new(&with, &told->rig->door, &fault), 0);
}

/* The whole way: hub, broker, link, bus, daemon. The daemon in the other process gets a snapshot by
 * its descriptor, then deltas; it is killed and starts again with nothing. */
static void the_link_works_over_the_bus(void **state)
{
    struct told *told = *state;
    struct link_rig *rig = told->rig;
    struct hub_zone *zone = fake_hub_zone(&rig->hub, 30);

    start_link(told);
    link_rig_run(rig, 200);
    assert_int_equal(link_rig_report(rig).phase, LINK_AWAY);
    told->service = bus_service_start(bus.address, &rig->daemon, true);
    link_rig_until(rig, told->came == 1);
    link_rig_until(rig, rig->hub.last_question.sequence == 30);
    fake_hub_change(&rig->hub, zone);
    fake_hub_publish(&rig->hub, zone, 31);
    link_rig_until(rig, rig->hub.last_question.sequence == 31);
    assert_int_equal(link_rig_report(rig).snapshots, 1);
    assert_int_equal(link_rig_report(rig).deltas, 1);
    bus_service_stop(told->service);
    fake_hub_change(&rig->hub, zone);
    fake_hub_publish(&rig->hub, zone, 32);
    link_rig_until(rig, link_rig_report(rig).phase == LINK_AWAY);
    rig->daemon.requests = 5;
    told->service = bus_service_start(bus.address, &rig->daemon, true);
    link_rig_until(rig, rig->hub.last_question.sequence == 32);
    assert_int_equal(link_rig_report(rig).snapshots, 2);
    link_rig_until(rig, rig->hub.requests == 5);
}

static void a_bus_that_is_restarted_is_found(void **state)
{
    struct told *told = *state;
    struct link_rig *rig = told->rig;
    struct hub_zone *zone = fake_hub_zone(&rig->hub, 0);

    start(told, true);
    start_link(told);
    link_rig_until(rig, link_rig_report(rig).phase == LINK_ONLINE);
    private_bus_kill(&bus);
    bus_service_stop(told->service);
    assert_int_equal(status_of(told), -ENOTCONN);
    assert_true(private_bus_revive(&bus));
    told->service = bus_service_start(bus.address, &rig->daemon, true);
    fake_hub_change(&rig->hub, zone);
    link_rig_until(rig, rig->hub.last_question.sequence == 1);
}

#define BUS_TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        BUS_TEST(the_state_is_read),
        BUS_TEST(a_daemon_without_a_fleet_is_told_from_one_that_is_away),
        BUS_TEST(messages_pass_through_the_bus),
        BUS_TEST(the_link_works_over_the_bus),
        BUS_TEST(a_bus_that_is_restarted_is_found),
    };

    if (!mosquitto_rig_is_there() || !private_bus_start(&bus)) {
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&bus);
    return failed;
}
