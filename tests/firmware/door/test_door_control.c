/* The door's machine on its lines: the null back end, and one that fails when told to. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "drivers/door/door_null.h"
#include "firmware/door/door_control.h"
#include "tests/support/devices/manual_clock.h"

#define MS ISO_NS_PER_MS

static int64_t now_ns;
static struct iso_door_io *io;
static struct iso_door_control control;
static char told[512]; /* "unlocked(grant) ..." */
static struct iso_door_outputs opened_with;
static bool weak_contact; /* of the weak back end */
static int failing;       /* what every operation on the lines fails with */
static const struct iso_door_outputs unpowered;
static const struct iso_door_options options = {.fail = ISO_DOOR_FAIL_SECURE,
                                                .unlock_ns = 4000 * MS,
                                                .held_ns = 30000 * MS,
                                                .refused_ns = 2000 * MS};
static const struct iso_door_timing timing = {50 * MS, 500 * MS, 1200 * MS};

static void on_changed(void *context, enum iso_door_event cause)
{
    const size_t used = strlen(told);
    assert_ptr_equal(context, &control);
    (void)snprintf(told + used, sizeof told - used, "%s(%s) ",
                   iso_door_state_name(control.door.state), iso_door_event_name(cause));
}

/* Since the last call. */
static const char *news(void)
{
    static char text[sizeof told];
    strcpy(text, told);
    told[0] = '\0';
    return text;
}

/* The null back end behind operations that can fail. */
static int weak_open(const struct iso_option *o, size_t n, const struct iso_clock *clock,
                     const struct iso_door_outputs *initial, void **self, struct iso_fault *fault)
{
    if (failing) {
        return iso_fault_set(fault, -EBUSY, "the wire is taken");
    }
    opened_with = *initial;
    return iso_door_null_ops.open(o, n, clock, initial, self, fault);
}

static int weak_set_output(void *self, enum iso_door_output output, bool active,
                           struct iso_fault *fault)
{
    return failing ? iso_fault_set(fault, failing, "the wire is cut")
                   : iso_door_null_ops.set_output(self, output, active, fault);
}

static int weak_get_inputs(void *self, struct iso_door_inputs *out, struct iso_fault *fault)
{
    if (failing) {
        return iso_fault_set(fault, failing, "the wire is cut");
    }
    const int error = iso_door_null_ops.get_inputs(self, out, fault);
    out->active[ISO_DOOR_CONTACT] |= weak_contact;
    return error;
}

static void weak_close(void *self)
{
    iso_door_null_ops.close(self);
}

static const struct iso_door_io_ops weak_ops = {
    .name = "weak",
    .open = weak_open,
    .set_output = weak_set_output,
    .get_inputs = weak_get_inputs,
    .close = weak_close,
};

static void prepare(const struct iso_door_io_ops *ops)
{
    const struct iso_clock clock = manual_clock(&now_ns);
    now_ns = 1000 * MS;
    told[0] = '\0';
    failing = 0;
    weak_contact = false;
    assert_int_equal(iso_door_io_open_ops(ops, NULL, 0, &clock, &unpowered, &io, NULL), 0);
    iso_door_control_init(&control, &options, &timing, io, on_changed, &control);
}

static int setup(void **state)
{
    (void)state;
    prepare(&iso_door_null_ops);
    return 0;
}

static int setup_weak(void **state)
{
    (void)state;
    prepare(&weak_ops);
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    iso_door_io_close(io);
    return 0;
}

static void set_input(enum iso_door_input input, bool active)
{
    assert_int_equal(iso_door_null_set_input(io, input, active), 0);
}

static bool output(enum iso_door_output which)
{
    bool active = false;
    assert_int_equal(iso_door_null_get_output(io, which, &active), 0);
    return active;
}

static void step_at(int64_t t_ms)
{
    now_ns = t_ms * MS;
    iso_door_control_step(&control, false, now_ns);
}

static void lets_in_and_locks_again(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    assert_string_equal(news(), "locked(start) ");
    assert_int_equal(iso_door_control_grant(&control, now_ns), ISO_DOOR_DID_UNLOCK);
    assert_true(output(ISO_DOOR_RELAY));
    assert_true(output(ISO_DOOR_LED_GRANTED));
    set_input(ISO_DOOR_CONTACT, true);
    step_at(1050);
    assert_false(output(ISO_DOOR_RELAY));
    set_input(ISO_DOOR_CONTACT, false);
    step_at(1100);
    assert_string_equal(news(), "unlocked(grant) opened(opened) locked(closed) ");
}

static void switches_only_what_differs(void **state)
{
    size_t before = 0, after = 0;
    (void)state;
    iso_door_control_start(&control, now_ns);
    assert_int_equal(iso_door_null_event_count(io, &before), 0);
    for (int t = 1050; t < 3000; t += 50) {
        step_at(t);
    }
    assert_int_equal(iso_door_null_event_count(io, &after), 0);
    assert_int_equal(after, before);
    iso_door_control_refuse(&control, now_ns);
    assert_int_equal(iso_door_null_event_count(io, &after), 0);
    assert_int_equal(after, before + 1);
}

static void reads_inputs_when_it_is_time(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    (void)news();
    set_input(ISO_DOOR_EXIT_BUTTON, true);
    assert_int_equal(iso_door_control_due_ns(&control), 1050 * MS);
    step_at(1049);
    assert_string_equal(news(), "");
    step_at(1050);
    assert_string_equal(news(), "unlocked(exit-button) ");
    set_input(ISO_DOOR_EXIT_BUTTON, false);
    iso_door_control_step(&control, true, now_ns);
    set_input(ISO_DOOR_EXIT_BUTTON, true); /* pressed and let go between two looks */
    set_input(ISO_DOOR_EXIT_BUTTON, false);
    step_at(2000);
    assert_int_equal(iso_door_due_ns(&control.door), 6000 * MS);
}

/* Inputs come before the time: who opens in the last moment does not force the door. */
static void gives_the_benefit_of_the_doubt(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    iso_door_control_grant(&control, now_ns);
    (void)news();
    set_input(ISO_DOOR_CONTACT, true);
    step_at(5040);
    assert_string_equal(news(), "opened(opened) ");
}

static void starts_with_the_door_open(void **state)
{
    (void)state;
    set_input(ISO_DOOR_CONTACT, true);
    set_input(ISO_DOOR_TAMPER, true);
    iso_door_control_start(&control, now_ns);
    assert_string_equal(news(), "opened(start-open) opened(tamper) ");
    step_at(31000);
    assert_string_equal(news(), "held-open(time) ");
}

static void rests_without_power(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    iso_door_control_grant(&control, now_ns);
    iso_door_control_stop(&control, now_ns);
    for (int i = 0; i < ISO_DOOR_OUTPUTS; i++) {
        assert_false(output((enum iso_door_output)i));
    }
    assert_int_equal(iso_door_control_due_ns(&control), ISO_NEVER_NS);
}

static void broken_lines_are_a_fault(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    failing = -EIO;
    step_at(1050);
    assert_string_equal(news(), "locked(start) fault(fault) ");
    assert_string_equal(control.fault.text, "the wire is cut");
    assert_int_equal(iso_door_control_grant(&control, now_ns), ISO_DOOR_DID_NOT_UNLOCK);
    assert_string_equal(news(), ""); /* nobody is let in */
    failing = 0;
    step_at(1100);
    assert_string_equal(news(), "locked(recovered) ");
    assert_false(iso_door_io_is_lost(io));
}

/* The lines fail while they are switched: nobody is told that the door is unlocked, and it is not
 * unlocked later either. */
static void a_grant_that_fails_is_withdrawn(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    (void)news();
    failing = -EIO;
    assert_int_equal(iso_door_control_grant(&control, now_ns), ISO_DOOR_DID_NOT_UNLOCK);
    assert_string_equal(news(), "fault(fault) ");
    failing = 0;
    step_at(1050);
    assert_string_equal(news(), "locked(recovered) ");
    assert_int_equal(iso_door_control_grant(&control, now_ns), ISO_DOOR_DID_UNLOCK);
    failing = -ENODEV; /* while it is unlocked: who was let in stays so */
    step_at(1100);
    assert_int_equal(control.door.state, ISO_DOOR_UNLOCKED);
    assert_int_equal(iso_door_control_grant(&control, now_ns), ISO_DOOR_DID_NOT_UNLOCK);
}

static void starts_at_fault_with_broken_lines(void **state)
{
    (void)state;
    failing = -EIO;
    iso_door_control_start(&control, now_ns);
    assert_string_equal(news(), "fault(start) ");
}

static void two_faults_must_both_end(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    iso_door_control_set_fault(&control, true, now_ns);
    failing = -EIO;
    step_at(1050);
    (void)news();
    iso_door_control_set_fault(&control, false, now_ns);
    assert_int_equal(control.door.state, ISO_DOOR_FAULT);
    failing = 0;
    step_at(1100);
    assert_int_equal(control.door.state, ISO_DOOR_LOCKED);
    iso_door_control_set_fault(&control, true, now_ns);
    failing = -EIO;
    step_at(1150);
    failing = 0;
    step_at(1200);
    assert_int_equal(control.door.state, ISO_DOOR_FAULT);
}

static void says_when_the_lines_are_gone(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    failing = -ENODEV;
    step_at(1050);
    assert_true(iso_door_io_is_lost(io));
    assert_string_equal(news(), "locked(start) fault(fault) ");
    assert_string_equal(control.fault.text, "the wire is cut");
}

/* The first try after 500 ms, then after 1000 and 1200, which is the longest wait; in between
 * nothing is touched. The times are those at which somebody steps. */
static void opens_lost_lines_anew(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    iso_door_control_grant(&control, now_ns);
    failing = -ENODEV;
    step_at(1050);
    (void)news();
    assert_int_equal(iso_door_control_due_ns(&control), 1550 * MS);
    step_at(1549);
    assert_string_equal(control.fault.text, "the wire is cut");
    step_at(1550);
    assert_string_equal(control.fault.text, "the wire is taken");
    assert_int_equal(iso_door_control_due_ns(&control), 2550 * MS);
    step_at(2550);
    assert_int_equal(iso_door_control_due_ns(&control), 3750 * MS);
    step_at(3750);
    assert_int_equal(iso_door_control_due_ns(&control), 4950 * MS);
    failing = 0;
    step_at(4949);
    assert_string_equal(news(), "");
    step_at(4950);
    assert_true(opened_with.active[ISO_DOOR_RELAY]); /* who was let in has 50 ms left */
    assert_string_equal(news(), "");
    assert_false(control.broken);
    step_at(5000);
    assert_string_equal(news(), "locked(time) ");
    failing = -ENODEV;
    step_at(5050);
    assert_int_equal(iso_door_control_due_ns(&control), 5550 * MS); /* begins anew */
    failing = 0;
    step_at(5550);
    assert_false(opened_with.active[ISO_DOOR_RELAY]);
    assert_string_equal(news(), "fault(fault) locked(recovered) ");
}

/* What happened to the door meanwhile is found out at once. */
static void sees_what_it_missed(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    failing = -ENODEV;
    step_at(1050);
    step_at(1550);
    (void)news();
    failing = 0;
    weak_contact = true;
    step_at(2550);
    assert_string_equal(news(), "forced(opened) ");
}

static void starts_without_lines(void **state)
{
    const struct iso_clock clock = manual_clock(&now_ns);
    (void)state;
    iso_door_io_close(io);
    now_ns = 1000 * MS;
    told[0] = '\0';
    assert_int_equal(iso_door_io_new("null", NULL, 0, &clock, &io, NULL), 0);
    iso_door_control_init(&control, &options, &timing, io, on_changed, &control);
    iso_door_control_start(&control, now_ns); /* opens them itself */
    assert_string_equal(news(), "locked(start) ");
    iso_door_control_stop(&control, now_ns);
}

static void starts_at_fault_without_lines(void **state)
{
    (void)state;
    failing = -ENODEV;
    struct iso_door_inputs inputs;
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), -ENODEV); /* now it is lost */
    iso_door_control_start(&control, now_ns);
    assert_string_equal(news(), "fault(start) ");
    assert_string_equal(control.fault.text, "the wire is taken");
    failing = 0;
    step_at(1500);
    assert_string_equal(news(), "locked(recovered) ");
    iso_door_control_stop(&control, now_ns);
}

static void stops_without_lines(void **state)
{
    (void)state;
    iso_door_control_start(&control, now_ns);
    failing = -ENODEV;
    step_at(1050);
    (void)news();
    iso_door_control_stop(&control, now_ns);
    assert_string_equal(news(), "stopped(stop) ");
}

/* A test needs lines that work, and says what is wrong with them. */
static void tests_the_relay(void **state)
{
    struct iso_fault fault = {.text = ""};
    (void)state;
    iso_door_control_start(&control, now_ns);
    assert_int_equal(iso_door_control_test(&control, now_ns, &fault), 0);
    assert_int_equal(iso_door_control_test(&control, now_ns, &fault), -EBUSY);
    assert_string_equal(fault.text, "the door is unlocked, not locked");
    now_ns += 500 * MS;
    iso_door_control_step(&control, false, now_ns);
    assert_int_equal(control.door.state, ISO_DOOR_LOCKED);
    failing = -EIO;
    assert_int_equal(iso_door_control_test(&control, now_ns, &fault), -ENODEV);
    assert_string_equal(fault.text, "the door's lines are at fault: the wire is cut");
    assert_int_equal(iso_door_control_may_test(&control, &fault), -ENODEV);
    assert_int_not_equal(control.door.state, ISO_DOOR_UNLOCKED); /* nor does it click later */
}

/* A pulse relay has dropped already when the grant is renewed, and then its line fails. */
static void a_renewal_that_fails_is_withdrawn(void **state)
{
    (void)state;
    control.door.options.pulse_ns = 100 * MS;
    iso_door_control_start(&control, now_ns);
    assert_int_equal(iso_door_control_grant(&control, now_ns), ISO_DOOR_DID_UNLOCK);
    now_ns += 200 * MS;
    iso_door_control_step(&control, false, now_ns);
    failing = -EIO;
    assert_int_equal(iso_door_control_grant(&control, now_ns), ISO_DOOR_DID_NOT_UNLOCK);
    failing = 0;
    now_ns += 10 * MS;
    iso_door_control_step(&control, true, now_ns);
    assert_false(iso_door_outputs_of(&control.door).active[ISO_DOOR_RELAY]);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
#define WEAK(f) cmocka_unit_test_setup_teardown(f, setup_weak, teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(tests_the_relay, setup_weak, teardown),
        WEAK(a_renewal_that_fails_is_withdrawn),
        TEST(lets_in_and_locks_again),
        TEST(switches_only_what_differs),
        TEST(reads_inputs_when_it_is_time),
        TEST(gives_the_benefit_of_the_doubt),
        TEST(starts_with_the_door_open),
        TEST(rests_without_power),
        WEAK(broken_lines_are_a_fault),
        WEAK(a_grant_that_fails_is_withdrawn),
        WEAK(starts_at_fault_with_broken_lines),
        WEAK(two_faults_must_both_end),
        WEAK(says_when_the_lines_are_gone),
        WEAK(opens_lost_lines_anew),
        WEAK(sees_what_it_missed),
        TEST(starts_without_lines),
        WEAK(starts_at_fault_without_lines),
        WEAK(stops_without_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
