/* Webhooks while processes die, lead at the same time, or have no database. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <time.h>

#include "tests/enroll/hub/outlet/webhook_rig.h"

/* The process dies while batches are handed over, again and again. */
static void no_event_is_lost_when_the_process_is_killed(void **state)
{
    struct store_rig *rig = *state;
    enum { DOORS = 6, EVENTS = 500, KILLS = 12 };
    struct iso_fleet_id doors[DOORS];
    receiver_delay(&webhook_rig_receiver, 20);
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    for (int i = 0; i < DOORS; i++) {
        char name[2] = {(char)('A' + i), '\0'};
        doors[i] = outlet_rig_door(rig, name);
    }
    pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    for (int kill = 0; kill < KILLS; kill++) {
        const struct timespec pause = {.tv_nsec = 150000000 + 17000000L * kill};
        for (int i = 0; i < DOORS; i++) {
            const uint64_t from = (uint64_t)kill * EVENTS + 1;
            outlet_rig_events(rig, &doors[i], from, from + EVENTS - 1, "visit");
        }
        (void)nanosleep(&pause, NULL);
        outlet_rig_kill(pid);
        pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    }
    outlet_rig_wait_idle(rig, "siem", 120);
    outlet_rig_end(pid);
    const struct arrivals arrivals = webhook_rig_arrivals();
    print_message("%zu events in %zu requests, %zu batches came twice\n", arrivals.events,
                  webhook_rig_receiver.n, arrivals.repeated_batches);
    assert_int_equal(arrivals.n_doors, DOORS);
    assert_int_equal(arrivals.events, DOORS * EVENTS * KILLS);
    assert_int_equal(outlet_rig_outlet(rig, "siem").delivered, DOORS * EVENTS * KILLS);
}

static void two_leaders_hand_over_nothing_twice_under_another_key(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    outlet_rig_events(rig, &a, 1, 3000, "visit");
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    const pid_t one = outlet_rig_run(rig, WEBHOOK_RIG_LOG),
                two = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    outlet_rig_wait_idle(rig, "siem", 60);
    outlet_rig_end(one);
    outlet_rig_end(two);
    assert_int_equal(webhook_rig_arrivals().events, 3000);
    assert_int_equal(outlet_rig_outlet(rig, "siem").delivered, 3000);
}

/* The process ends at once although the receiver hangs, and the database may be away for a while.
 */
static void it_survives_the_database_and_ends_at_once(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    outlet_rig_events(rig, &a, 1, 1, "visit");
    outlet_rig_wait_idle(rig, "siem", 20);
    rig_postgres_down(&rig->postgres);
    const struct timespec pause = {.tv_sec = 3};
    (void)nanosleep(&pause, NULL);
    rig_postgres_up(&rig->postgres);
    hub_store_close(&rig->store);
    store_rig_open(rig, &rig->store);
    outlet_rig_events(rig, &a, 2, 2, "visit");
    outlet_rig_wait_idle(rig, "siem", 20);
    assert_int_equal(webhook_rig_arrivals().events, 2);
    receiver_delay(&webhook_rig_receiver, 8000);
    outlet_rig_events(rig, &a, 3, 3, "visit");
    receiver_wait(&webhook_rig_receiver, 3, 20);
    outlet_rig_end(pid);
    assert_true(outlet_rig_outlet(rig, "siem").in_flight);
    receiver_delay(&webhook_rig_receiver, 0);
}

int main(int argc, char **argv)
{
    outlet_rig_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(no_event_is_lost_when_the_process_is_killed,
                                        webhook_rig_setup, webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(two_leaders_hand_over_nothing_twice_under_another_key,
                                        webhook_rig_setup, webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(it_survives_the_database_and_ends_at_once,
                                        webhook_rig_setup, webhook_rig_teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
