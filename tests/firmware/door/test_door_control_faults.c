/* The state machine of a door on lines that fail or are missing. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/firmware/door/door_rig.h"
#include "tests/support/devices/manual_clock.h"

static void broken_lines_are_a_fault(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    door_rig_failing = -EIO;
    door_rig_step_at(1050);
    assert_string_equal(door_rig_news(), "locked(start) fault(fault) ");
    assert_string_equal(door_rig_control.fault.text, "the wire is cut");
    assert_int_equal(iso_door_control_grant(&door_rig_control, door_rig_now_ns),
                     ISO_DOOR_DID_NOT_UNLOCK);
    assert_string_equal(door_rig_news(), ""); /* nobody is admitted */
    door_rig_failing = 0;
    door_rig_step_at(1100);
    assert_string_equal(door_rig_news(), "locked(recovered) ");
    assert_false(iso_door_io_is_lost(door_rig_io));
}

/* The lines fail while they are switched. The door does not report that it is unlocked, and it does
 * not unlock later either. */
static void a_grant_that_fails_is_withdrawn(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    (void)door_rig_news();
    door_rig_failing = -EIO;
    assert_int_equal(iso_door_control_grant(&door_rig_control, door_rig_now_ns),
                     ISO_DOOR_DID_NOT_UNLOCK);
    assert_string_equal(door_rig_news(), "fault(fault) ");
    door_rig_failing = 0;
    door_rig_step_at(1050);
    assert_string_equal(door_rig_news(), "locked(recovered) ");
    assert_int_equal(iso_door_control_grant(&door_rig_control, door_rig_now_ns),
                     ISO_DOOR_DID_UNLOCK);
    door_rig_failing = -ENODEV; /* while it is unlocked: the grant stays valid */
    door_rig_step_at(1100);
    assert_int_equal(door_rig_control.door.state, ISO_DOOR_UNLOCKED);
    assert_int_equal(iso_door_control_grant(&door_rig_control, door_rig_now_ns),
                     ISO_DOOR_DID_NOT_UNLOCK);
}

static void starts_at_fault_with_broken_lines(void **state)
{
    (void)state;
    door_rig_failing = -EIO;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    assert_string_equal(door_rig_news(), "fault(start) ");
}

static void two_faults_must_both_end(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    iso_door_control_set_fault(&door_rig_control, true, door_rig_now_ns);
    door_rig_failing = -EIO;
    door_rig_step_at(1050);
    (void)door_rig_news();
    iso_door_control_set_fault(&door_rig_control, false, door_rig_now_ns);
    assert_int_equal(door_rig_control.door.state, ISO_DOOR_FAULT);
    door_rig_failing = 0;
    door_rig_step_at(1100);
    assert_int_equal(door_rig_control.door.state, ISO_DOOR_LOCKED);
    iso_door_control_set_fault(&door_rig_control, true, door_rig_now_ns);
    door_rig_failing = -EIO;
    door_rig_step_at(1150);
    door_rig_failing = 0;
    door_rig_step_at(1200);
    assert_int_equal(door_rig_control.door.state, ISO_DOOR_FAULT);
}

static void says_when_the_lines_are_gone(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    door_rig_failing = -ENODEV;
    door_rig_step_at(1050);
    assert_true(iso_door_io_is_lost(door_rig_io));
    assert_string_equal(door_rig_news(), "locked(start) fault(fault) ");
    assert_string_equal(door_rig_control.fault.text, "the wire is cut");
}

/* Lines without a descriptor are read at every interval, and so are lines that do not work. */
static void lines_that_wake_nobody_are_read_every_50_ms(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 1050 * MS);
    door_rig_step_at(1050);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 1100 * MS);
    door_rig_weak_fd = 7;
    door_rig_step_at(1100);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 1300 * MS);
    door_rig_failing = -EIO;
    iso_door_control_refuse(&door_rig_control, 1110 * MS); /* a light cannot be switched on */
    assert_true(door_rig_control.broken);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 1160 * MS);
    door_rig_step_at(1160);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 1210 * MS);
    door_rig_failing = 0;
    door_rig_step_at(1210);
    assert_false(door_rig_control.broken);
    door_rig_step_at(1260);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 1460 * MS);
}

/* The first try follows after 500 ms, the next ones after 1000 and 1200, which is the longest wait.
 * Between them no line is touched. The times are those of the steps. */
static void opens_lost_lines_anew(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    iso_door_control_grant(&door_rig_control, door_rig_now_ns);
    door_rig_failing = -ENODEV;
    door_rig_step_at(1050);
    (void)door_rig_news();
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 1550 * MS);
    door_rig_step_at(1549);
    assert_string_equal(door_rig_control.fault.text, "the wire is cut");
    door_rig_step_at(1550);
    assert_string_equal(door_rig_control.fault.text, "the wire is taken");
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 2550 * MS);
    door_rig_step_at(2550);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 3750 * MS);
    door_rig_step_at(3750);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control), 4950 * MS);
    door_rig_failing = 0;
    door_rig_step_at(4949);
    assert_string_equal(door_rig_news(), "");
    door_rig_step_at(4950);
    assert_true(door_rig_opened_with.active[ISO_DOOR_RELAY]); /* 50 ms of the grant are left */
    assert_string_equal(door_rig_news(), "");
    assert_false(door_rig_control.broken);
    door_rig_step_at(5000);
    assert_string_equal(door_rig_news(), "locked(time) ");
    door_rig_failing = -ENODEV;
    door_rig_step_at(5050);
    assert_int_equal(iso_door_control_due_ns(&door_rig_control),
                     5550 * MS); /* the waits start again */
    door_rig_failing = 0;
    door_rig_step_at(5550);
    assert_false(door_rig_opened_with.active[ISO_DOOR_RELAY]);
    assert_string_equal(door_rig_news(), "fault(fault) locked(recovered) ");
}

/* When the lines work again, the machine finds at once what happened to the door meanwhile. */
static void sees_changes_from_the_time_without_lines(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    door_rig_failing = -ENODEV;
    door_rig_step_at(1050);
    door_rig_step_at(1550);
    (void)door_rig_news();
    door_rig_failing = 0;
    door_rig_weak_contact = true;
    door_rig_step_at(2550);
    assert_string_equal(door_rig_news(), "forced(opened) ");
}

static void starts_without_lines(void **state)
{
    const struct iso_clock clock = manual_clock(&door_rig_now_ns);
    (void)state;
    iso_door_io_close(door_rig_io);
    door_rig_now_ns = 1000 * MS;
    door_rig_told[0] = '\0';
    assert_int_equal(iso_door_io_new("null", NULL, 0, &clock, &door_rig_io, NULL), 0);
    iso_door_control_init(&door_rig_control, &door_rig_options, &door_rig_timing, door_rig_io,
                          door_rig_on_changed, &door_rig_control);
    iso_door_control_start(&door_rig_control,
                           door_rig_now_ns); /* the start opens the lines itself */
    assert_string_equal(door_rig_news(), "locked(start) ");
    iso_door_control_stop(&door_rig_control, door_rig_now_ns);
}

static void starts_at_fault_without_lines(void **state)
{
    (void)state;
    door_rig_failing = -ENODEV;
    struct iso_door_inputs inputs;
    assert_int_equal(iso_door_io_get_inputs(door_rig_io, &inputs, NULL),
                     -ENODEV); /* now the line is lost */
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    assert_string_equal(door_rig_news(), "fault(start) ");
    assert_string_equal(door_rig_control.fault.text, "the wire is taken");
    door_rig_failing = 0;
    door_rig_step_at(1500);
    assert_string_equal(door_rig_news(), "locked(recovered) ");
    iso_door_control_stop(&door_rig_control, door_rig_now_ns);
}

static void stops_without_lines(void **state)
{
    (void)state;
    iso_door_control_start(&door_rig_control, door_rig_now_ns);
    door_rig_failing = -ENODEV;
    door_rig_step_at(1050);
    (void)door_rig_news();
    iso_door_control_stop(&door_rig_control, door_rig_now_ns);
    assert_string_equal(door_rig_news(), "stopped(stop) ");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, door_rig_setup, door_rig_teardown)
#define WEAK(f) cmocka_unit_test_setup_teardown(f, door_rig_setup_weak, door_rig_teardown)
    const struct CMUnitTest tests[] = {
        WEAK(broken_lines_are_a_fault),
        WEAK(a_grant_that_fails_is_withdrawn),
        WEAK(starts_at_fault_with_broken_lines),
        WEAK(two_faults_must_both_end),
        WEAK(says_when_the_lines_are_gone),
        WEAK(lines_that_wake_nobody_are_read_every_50_ms),
        WEAK(opens_lost_lines_anew),
        WEAK(sees_changes_from_the_time_without_lines),
        TEST(starts_without_lines),
        WEAK(starts_at_fault_without_lines),
        WEAK(stops_without_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
