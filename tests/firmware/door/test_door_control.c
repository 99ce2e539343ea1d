/* The state machine of the door on its lines: on the null back end, and on a back end that fails on
 * request. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/firmware/door/door_rig.h"
#include "tests/support/devices/manual_clock.h"

static void lets_in_and_locks_again(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    assert_string_equal(door_rig_news(), "locked(start) ");
    assert_int_equal(iso_door_control_grant(&door_rig_control, door_rig_now_ns),
                     ISO_DOOR_DID_UNLOCK);
    assert_true(door_rig_output(ISO_DOOR_RELAY));
    assert_true(door_rig_output(ISO_DOOR_LED_GRANTED));
    door_rig_set_input(ISO_DOOR_CONTACT, true);
    door_rig_step_at(1200);
    assert_false(door_rig_output(ISO_DOOR_RELAY));
    door_rig_set_input(ISO_DOOR_CONTACT, false);
    door_rig_step_at(1400);
    assert_string_equal(door_rig_news(), "unlocked(grant) opened(opened) locked(closed) ");
}

static void switches_only_changed_outputs(void **state)
{
    size_t before = 0, after = 0;
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    assert_int_equal(iso_door_null_event_count(door_rig_io, &before), 0);
    for (int t = 1050; t < 3000; t += 50) {
        door_rig_step_at(t);
    }
    assert_int_equal(iso_door_null_event_count(door_rig_io, &after), 0);
    assert_int_equal(after, before);
    iso_door_control_refuse(&door_rig_control, door_rig_now_ns);
    assert_int_equal(iso_door_null_event_count(door_rig_io, &after), 0);
    assert_int_equal(after, before + 1);
}

static void reads_inputs_when_it_is_time(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    (void)door_rig_news();
    door_rig_set_input(ISO_DOOR_EXIT_BUTTON, true);
    /* The descriptor of the lines wakes the caller for the button, not the time. */
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 1200 * MS);
    door_rig_step_at(1199);
    assert_string_equal(door_rig_news(), "");
    door_rig_step_at(1200);
    assert_string_equal(door_rig_news(), "unlocked(exit-button) ");
    door_rig_set_input(ISO_DOOR_EXIT_BUTTON, false);
    iso_door_control_step(&door_rig_control, true, door_rig_now_ns);
    door_rig_set_input(ISO_DOOR_EXIT_BUTTON, true); /* pressed and released between two steps */
    door_rig_set_input(ISO_DOOR_EXIT_BUTTON, false);
    door_rig_step_at(2000);
    assert_int_equal(iso_door_due_ns(&door_rig_control.door), 6000 * MS);
}

/* Inputs are handled before the time. A person who opens the door in the last moment does not force
 * it. */
static void an_opening_in_the_last_moment_is_not_forced(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    iso_door_control_grant(&door_rig_control, door_rig_now_ns);
    (void)door_rig_news();
    door_rig_set_input(ISO_DOOR_CONTACT, true);
    door_rig_step_at(5040);
    assert_string_equal(door_rig_news(), "opened(opened) ");
}

static void starts_with_the_door_open(void **state)
{
    (void)state;
    door_rig_set_input(ISO_DOOR_CONTACT, true);
    door_rig_set_input(ISO_DOOR_TAMPER, true);
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    assert_string_equal(door_rig_news(), "opened(start-open) opened(tamper) ");
    door_rig_step_at(31000);
    assert_string_equal(door_rig_news(), "held-open(time) ");
}

static void rests_without_power(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    iso_door_control_grant(&door_rig_control, door_rig_now_ns);
    iso_door_control_stop(&door_rig_control, door_rig_now_ns);
    for (int i = 0; i < ISO_DOOR_OUTPUTS; i++) {
        assert_false(door_rig_output((enum iso_door_output)i));
    }
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), ISO_NEVER_NS);
}

/* A test needs working lines, and reports their fault. */
static void tests_the_relay(void **state)
{
    struct iso_fault fault = {.text = ""};
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    assert_int_equal(iso_door_control_test(&door_rig_control, door_rig_now_ns, &fault), 0);
    assert_int_equal(iso_door_control_test(&door_rig_control, door_rig_now_ns, &fault), -EBUSY);
    assert_string_equal(fault.text, "the door is unlocked, not locked");
    door_rig_now_ns += 500 * MS;
    iso_door_control_step(&door_rig_control, false, door_rig_now_ns);
    assert_int_equal(door_rig_control.door.state, ISO_DOOR_LOCKED);
    door_rig_failing = -EIO;
    assert_int_equal(iso_door_control_test(&door_rig_control, door_rig_now_ns, &fault), -ENODEV);
    assert_string_equal(fault.text, "the door's lines are at fault: the wire is cut");
    assert_int_equal(iso_door_control_may_test(&door_rig_control, &fault), -ENODEV);
    assert_int_not_equal(door_rig_control.door.state,
                         ISO_DOOR_UNLOCKED); /* the lock does not switch later either */
}

/* The relay of a pulse lock is off already when the grant is renewed. Then its line fails. */
static void a_renewal_that_fails_is_withdrawn(void **state)
{
    (void)state;
    door_rig_control.door.options.pulse_ns = 100 * MS;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    assert_int_equal(iso_door_control_grant(&door_rig_control, door_rig_now_ns),
                     ISO_DOOR_DID_UNLOCK);
    door_rig_now_ns += 200 * MS;
    iso_door_control_step(&door_rig_control, false, door_rig_now_ns);
    door_rig_failing = -EIO;
    assert_int_equal(iso_door_control_grant(&door_rig_control, door_rig_now_ns),
                     ISO_DOOR_DID_NOT_UNLOCK);
    door_rig_failing = 0;
    door_rig_now_ns += 10 * MS;
    iso_door_control_step(&door_rig_control, true, door_rig_now_ns);
    assert_false(iso_door_outputs_of(&door_rig_control.door).active[ISO_DOOR_RELAY]);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, door_rig_setup, door_rig_teardown)
#define WEAK(f) cmocka_unit_test_setup_teardown(f, door_rig_setup_weak, door_rig_teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(tests_the_relay, door_rig_setup_weak, door_rig_teardown),
        WEAK(a_renewal_that_fails_is_withdrawn),
        TEST(lets_in_and_locks_again),
        TEST(switches_only_changed_outputs),
        TEST(reads_inputs_when_it_is_time),
        TEST(an_opening_in_the_last_moment_is_not_forced),
        TEST(starts_with_the_door_open),
        TEST(rests_without_power),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
