/* What may break while the hub runs: the leader dies, the database or the broker goes away. No
 * change is lost. */
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/store/hub_zone.h"
#include "firmware/fleet/message/head.h"
#include "tests/enroll/hub/rigs/served_door.h"
#include "tests/support/scratch.h"

/* How often the door's client has got a delta, and when it got the first one after `since_s`. */
static int count_deltas(double since_s, double *first_s)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    int n = 0;

    *first_s = 0;
    (void)iso_fleet_topic_delta(&rig.zone, topic);
    for (size_t i = 0; i < door.client.n; i++) {
        const double at_s = 1e-9 * (double)door.client.messages[i].at_ns;
        if (strcmp(door.client.messages[i].topic, topic) == 0) {
            n++;
            if (at_s > since_s && (*first_s == 0 || at_s < *first_s)) {
                *first_s = at_s;
            }
        }
    }
    return n;
}

static void follow_until(uint64_t sequence)
{
    for (int i = 0; i < 1000 && door.place.sequence < sequence; i++) {
        (void)usleep(10000);
        (void)door_rig_follow(&door, 0);
    }
    assert_int_equal(door.place.sequence, sequence); /* each follows the one before it */
}

/* A hub that sent again what a slow broker has not acknowledged would give it the more to do. */
static void a_slow_broker_gets_each_change_once(void **state)
{
    enum { CHANGES = 12 };
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    double first_s;
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    (void)hub_rig_leader(&rig);
    assert_int_equal(kill(rig.broker.pid, SIGSTOP), 0);
    for (int i = 0; i < CHANGES; i++) {
        served_ok(hub_zone_lockdown(&rig.store, &rig.zone, i % 2 == 0, &fault), &fault);
        (void)usleep(20000);
    }
    (void)sleep(8);
    assert_int_equal(kill(rig.broker.pid, SIGCONT), 0);
    follow_until(CHANGES);
    (void)sleep(2);
    (void)door_rig_follow(&door, 0);
    assert_int_equal(count_deltas(0, &first_s), CHANGES);
}

static void another_hub_takes_over(void **state)
{
    enum { CHANGES = 60 };
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    double killed = 0, first = 0;
    (void)state;

    served_door_begin();
    hub_rig_serve(&rig, 1);
    served_door_connect(&lease);
    const int leader = hub_rig_leader(&rig);
    for (int i = 0; i < CHANGES; i++) {
        served_ok(hub_zone_lockdown(&rig.store, &rig.zone, i % 2 == 0, &fault), &fault);
        if (i == CHANGES / 3) {
            hub_rig_kill(&rig, leader);
            killed = served_now_s();
        }
        (void)usleep(30000);
    }
    (void)hub_rig_leader(&rig);
    follow_until(CHANGES);
    const int delivered = count_deltas(killed, &first);
    print_message(
        "the first delta after the death of the leader came after %.2f s; %d of %d deltas "
        "came twice\n",
        first - killed, delivered - CHANGES, CHANGES);
    assert_true(first > killed && first - killed < 5);
    /* The other one answers mail, too. */
    assert_true(door_rig_ask(&door, "{}", 0, &lease, 10));
}

static void the_database_may_go_away_for_a_while(void **state)
{
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    char topic[ISO_FLEET_TOPIC_SIZE];
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    rig_postgres_down(rig.postgres);
    assert_false(door_rig_ask(&door, "{}", 0, &lease, 2));
    rig_postgres_up(rig.postgres);
    assert_true(door_rig_ask(&door, "{}", 0, &lease, 10));
    const size_t from = door.client.n;
    /* The first statement finds the connection of the test lost. */
    (void)!hub_zone_lockdown(&rig.store, &rig.zone, true, &fault);
    served_ok(hub_zone_lockdown(&rig.store, &rig.zone, true, &fault), &fault);
    (void)iso_fleet_topic_delta(&rig.zone, topic);
    assert_true(broker_client_wait(&door.client, topic, from, 10) >= 0);
    assert_int_equal(hub_rig_says(&rig, 0, "database: it is there again"), 1);
}

static void the_broker_may_go_away_for_a_while(void **state)
{
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_head head = {.time_s = 0};
    char topic[ISO_FLEET_TOPIC_SIZE];
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    broker_client_end(&door.client);
    broker_rig_stop(&rig.broker);
    served_ok(hub_zone_lockdown(&rig.store, &rig.zone, true, &fault), &fault);
    broker_rig_start(&rig.broker, scratch_path(rig.broker_folder, "mosquitto.conf"),
                     rig.hub_broker_port, scratch_path(rig.folder, "broker.log"));
    assert_true(door_rig_connect(&door, &rig.zone));
    (void)iso_fleet_topic_head(&rig.zone, topic);
    /* The broker has forgotten what it retained; the head comes again, with the change. */
    for (int at = 0; head.place.sequence < 1; at++) {
        at = broker_client_wait(&door.client, topic, (size_t)at, 10);
        assert_true(at >= 0);
        const struct broker_message *m = &door.client.messages[at];
        assert_int_equal(iso_fleet_read_head(m->bytes, m->size, door.membership.hub_signs, &head),
                         0);
    }
    assert_true(door_rig_ask(&door, "{}", 0, &lease, 10));
    assert_int_equal(lease.places[0].sequence, 1);
}

/* hub_process keeps acts for thirty days. */
static void the_leader_deletes_old_acts(void **state)
{
    struct iso_fault fault = {.text = ""};
    PGresult *rows = NULL;
    int64_t left = 1;
    (void)state;

    served_door_begin();
    hub_rig_kill(&rig, 0);
    served_ok(hub_db_script(rig.store.db,
                            "INSERT INTO act (time_s, actor, what, object) SELECT "
                            "extract(epoch FROM now())::bigint - d * 86400, 'a', 'old', 'c' "
                            "FROM unnest(ARRAY[29, 31, 31]) d; "
                            "INSERT INTO act (time_s, actor, what, object) VALUES "
                            "(extract(epoch FROM now())::bigint, 'a', 'new', 'c')",
                            &fault),
              &fault);
    hub_rig_serve(&rig, 0);
    for (int i = 0; left != 0; i++) {
        assert_true(i < 200);
        (void)usleep(100000);
        served_ok(hub_db_run(rig.store.db, "SELECT abs(count(*) - 1) FROM act WHERE what = 'old'",
                             NULL, &rows, &fault),
                  &fault);
        left = hub_row_integer(rows, 0, 0);
        PQclear(rows);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        SERVED_TEST(the_leader_deletes_old_acts),
        SERVED_TEST(a_slow_broker_gets_each_change_once),
        SERVED_TEST(another_hub_takes_over),
        SERVED_TEST(the_database_may_go_away_for_a_while),
        SERVED_TEST(the_broker_may_go_away_for_a_while),
    };
    return cmocka_run_group_tests(tests, NULL, hub_rig_end);
}
