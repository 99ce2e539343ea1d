/* The door's state machine: every event in every state. A second copy of the table in the header
 * gives the expected results. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/door/door.h"

#define S ISO_NS_PER_S

static const struct iso_door_options secure = {ISO_DOOR_FAIL_SECURE, 4 * S, 30 * S, 2 * S, 0};
static const struct iso_door_options safe = {ISO_DOOR_FAIL_SAFE, 4 * S, 30 * S, 2 * S, 0};

/* Brings a door to a state by legal events only, at time 100 s. With `fault` a fault is present. */
static struct iso_door door_in(const struct iso_door_options *options, enum iso_door_state state,
                               bool fault)
{
    struct iso_door door;
    iso_door_init(&door, options);
    if (state != ISO_DOOR_STOPPED) {
        iso_door_handle(&door, ISO_DOOR_ON_START, 10 * S);
    }
    switch (state) {
    case ISO_DOOR_UNLOCKED:
        iso_door_handle(&door, ISO_DOOR_ON_GRANT, 100 * S);
        break;
    case ISO_DOOR_OPENED:
        iso_door_handle(&door, ISO_DOOR_ON_GRANT, 100 * S);
        iso_door_handle(&door, ISO_DOOR_ON_OPENED, 100 * S);
        break;
    case ISO_DOOR_HELD_OPEN:
        iso_door_handle(&door, ISO_DOOR_ON_GRANT, 60 * S);
        iso_door_handle(&door, ISO_DOOR_ON_OPENED, 61 * S);
        iso_door_handle(&door, ISO_DOOR_ON_TIME, 100 * S);
        break;
    case ISO_DOOR_FORCED:
        iso_door_handle(&door, ISO_DOOR_ON_OPENED, 100 * S);
        break;
    default:
        break;
    }
    if (fault) {
        iso_door_handle(&door, ISO_DOOR_ON_FAULT, 100 * S);
    }
    assert_int_equal(door.state, state);
    return door;
}

static const char *const legal =
    "stopped  start        locked\n"
    "stopped  start-open   opened\n"
    "locked   grant        unlocked\n"
    "locked   test         unlocked\n"
    "locked   exit-button  unlocked\n"
    "locked   opened       forced\n"
    "locked   fault        fault\n"
    "fault    exit-button  unlocked\n"
    "fault    recovered    locked\n"
    "fault    opened       forced-or-opened\n"
    "unlocked opened       opened\n"
    "opened   closed       locked\n"
    "held-open closed      locked\n"
    "forced   closed       locked\n"
    "unlocked not-switched locked\n"
    "locked stop stopped\nunlocked stop stopped\nopened stop stopped\nheld-open stop stopped\n"
    "forced stop stopped\nfault stop stopped\n";

/* Returns the expected state after an event. Other tests check the events of time. */
static const char *expected(const char *state, const char *event, bool fail_safe)
{
    char from[16], on[16], to[24];
    int used = 0;
    for (const char *at = legal; sscanf(at, "%15s %15s %23s%n", from, on, to, &used) == 3;
         at += used) {
        if (strcmp(from, state) == 0 && strcmp(on, event) == 0) {
            for (int i = 0; i < ISO_DOOR_STATES; i++) {
                const char *name = iso_door_state_name((enum iso_door_state)i);
                if (strcmp(name, to) == 0) {
                    return name;
                }
            }
            return fail_safe ? "opened" : "forced";
        }
    }
    return state;
}

static void follows_the_table(void **state)
{
    (void)state;
    for (int fail = 0; fail < 2; fail++) {
        const struct iso_door_options *options = fail ? &safe : &secure;
        for (int s = 0; s < ISO_DOOR_STATES; s++) {
            for (int e = 0; e < ISO_DOOR_ON_TIME; e++) {
                const bool fault = s == ISO_DOOR_FAULT;
                const int before = fault ? ISO_DOOR_LOCKED : s;
                struct iso_door door = door_in(options, (enum iso_door_state)before, false);
                if (fault) {
                    iso_door_handle(&door, ISO_DOOR_ON_FAULT, 100 * S);
                }
                const char *from = iso_door_state_name(door.state);
                const char *event = iso_door_event_name((enum iso_door_event)e);
                const bool changed = iso_door_handle(&door, (enum iso_door_event)e, 101 * S);
                assert_string_equal(iso_door_state_name(door.state), expected(from, event, fail));
                assert_int_equal(changed, strcmp(from, expected(from, event, fail)) != 0);
            }
        }
    }
}

/* A door that shuts while a fault is present goes to the state `fault`. */
static void rests_in_fault_while_one_lasts(void **state)
{
    (void)state;
    struct iso_door door = door_in(&secure, ISO_DOOR_OPENED, true);
    iso_door_handle(&door, ISO_DOOR_ON_CLOSED, 101 * S);
    assert_int_equal(door.state, ISO_DOOR_FAULT);
    door = door_in(&secure, ISO_DOOR_UNLOCKED, true);
    iso_door_handle(&door, ISO_DOOR_ON_TIME, 104 * S);
    assert_int_equal(door.state, ISO_DOOR_FAULT);
    iso_door_handle(&door, ISO_DOOR_ON_GRANT, 105 * S);
    assert_int_equal(door.state, ISO_DOOR_FAULT); /* nobody is admitted */
    iso_door_handle(&door, ISO_DOOR_ON_EXIT_BUTTON, 106 * S);
    assert_int_equal(door.state, ISO_DOOR_UNLOCKED); /* but people may leave */
    iso_door_handle(&door, ISO_DOOR_ON_RECOVERED, 107 * S);
    iso_door_handle(&door, ISO_DOOR_ON_TIME, 110 * S);
    assert_int_equal(door.state, ISO_DOOR_LOCKED);
}

static void starts_at_fault_if_one_lasts(void **state)
{
    struct iso_door door;
    (void)state;
    iso_door_init(&door, &secure);
    iso_door_handle(&door, ISO_DOOR_ON_FAULT, 0);
    assert_int_equal(door.state, ISO_DOOR_STOPPED);
    iso_door_handle(&door, ISO_DOOR_ON_START, 0);
    assert_int_equal(door.state, ISO_DOOR_FAULT);
}

static void locks_again_in_time(void **state)
{
    (void)state;
    struct iso_door door = door_in(&secure, ISO_DOOR_UNLOCKED, false);
    assert_int_equal(iso_door_due_ns(&door), 104 * S);
    assert_false(iso_door_handle(&door, ISO_DOOR_ON_TIME, 104 * S - 1));
    assert_true(iso_door_handle(&door, ISO_DOOR_ON_TIME, 104 * S));
    assert_int_equal(door.state, ISO_DOOR_LOCKED);
    assert_int_equal(iso_door_due_ns(&door), ISO_NEVER_NS);
}

static void stays_unlocked_for_the_next_one(void **state)
{
    (void)state;
    struct iso_door door = door_in(&secure, ISO_DOOR_UNLOCKED, false);
    assert_false(iso_door_handle(&door, ISO_DOOR_ON_GRANT, 103 * S));
    assert_int_equal(iso_door_due_ns(&door), 107 * S);
    assert_false(iso_door_handle(&door, ISO_DOOR_ON_EXIT_BUTTON, 106 * S));
    assert_int_equal(iso_door_due_ns(&door), 110 * S);
    iso_door_handle(&door, ISO_DOOR_ON_FAULT, 107 * S);
    iso_door_handle(&door, ISO_DOOR_ON_GRANT, 108 * S);
    assert_int_equal(iso_door_due_ns(&door), 110 * S); /* not while a fault is present */
}

static void sounds_when_held_open(void **state)
{
    (void)state;
    struct iso_door door = door_in(&secure, ISO_DOOR_OPENED, false);
    assert_false(iso_door_handle(&door, ISO_DOOR_ON_TIME, 130 * S - 1));
    assert_true(iso_door_handle(&door, ISO_DOOR_ON_TIME, 130 * S));
    assert_int_equal(door.state, ISO_DOOR_HELD_OPEN);
    assert_true(iso_door_outputs_of(&door).active[ISO_DOOR_BUZZER]);
}

static void shows_a_refusal_for_a_while(void **state)
{
    (void)state;
    struct iso_door door = door_in(&secure, ISO_DOOR_LOCKED, false);
    iso_door_handle(&door, ISO_DOOR_ON_REFUSE, 100 * S);
    assert_int_equal(iso_door_due_ns(&door), 102 * S);
    assert_true(iso_door_outputs_of(&door).active[ISO_DOOR_LED_REFUSED]);
    assert_false(iso_door_handle(&door, ISO_DOOR_ON_TIME, 102 * S));
    assert_false(iso_door_outputs_of(&door).active[ISO_DOOR_LED_REFUSED]);
    iso_door_handle(&door, ISO_DOOR_ON_REFUSE, 103 * S);
    iso_door_handle(&door, ISO_DOOR_ON_GRANT, 104 * S);
    assert_false(iso_door_outputs_of(&door).active[ISO_DOOR_LED_REFUSED]);
}

/* One letter for each active output: Relay, Granted, reFused, Buzzer. */
static const char *levels(const struct iso_door *door)
{
    static char text[5];
    const struct iso_door_outputs out = iso_door_outputs_of(door);
    (void)snprintf(text, sizeof text, "%s%s%s%s", out.active[ISO_DOOR_RELAY] ? "R" : "",
                   out.active[ISO_DOOR_LED_GRANTED] ? "G" : "",
                   out.active[ISO_DOOR_LED_REFUSED] ? "F" : "",
                   out.active[ISO_DOOR_BUZZER] ? "B" : "");
    return text;
}

static void switches_by_state(void **state)
{
    static const struct {
        enum iso_door_state state;
        const char *secure, *safe;
    } wanted[] = {
        {ISO_DOOR_STOPPED, "", ""},      {ISO_DOOR_LOCKED, "", "R"},
        {ISO_DOOR_UNLOCKED, "RG", "G"},  {ISO_DOOR_OPENED, "G", "RG"},
        {ISO_DOOR_HELD_OPEN, "B", "RB"}, {ISO_DOOR_FORCED, "B", "RB"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        struct iso_door door = door_in(&secure, wanted[i].state, false);
        assert_string_equal(levels(&door), wanted[i].secure);
        door = door_in(&safe, wanted[i].state, false);
        assert_string_equal(levels(&door), wanted[i].safe);
    }
    struct iso_door door = door_in(&safe, ISO_DOOR_LOCKED, false);
    iso_door_handle(&door, ISO_DOOR_ON_FAULT, 100 * S);
    assert_string_equal(levels(&door), ""); /* no power: a fail-safe lock is open */
    iso_door_handle(&door, ISO_DOOR_ON_OPENED, 100 * S);
    assert_int_equal(door.state, ISO_DOOR_OPENED); /* and this is no break-in */
}

/* The lock gets its pulse, and the door stays unlocked without power on it. For a magnet, the pulse
 * takes the power away. */
static void pulses_the_relay(void **state)
{
    (void)state;
    for (int fail = 0; fail < 2; fail++) {
        struct iso_door_options options = fail ? safe : secure;
        const char *pulse = fail ? "G" : "RG", *over = fail ? "RG" : "G";
        options.pulse_ns = S / 2;
        struct iso_door door = door_in(&options, ISO_DOOR_UNLOCKED, false);
        assert_string_equal(levels(&door), pulse);
        assert_int_equal(iso_door_due_ns(&door), 100 * S + S / 2);
        assert_false(iso_door_handle(&door, ISO_DOOR_ON_TIME, 100 * S + S / 2 - 1));
        assert_string_equal(levels(&door), pulse);
        assert_false(iso_door_handle(&door, ISO_DOOR_ON_TIME, 100 * S + S / 2));
        assert_string_equal(levels(&door), over);
        assert_int_equal(iso_door_due_ns(&door), 104 * S);
        iso_door_handle(&door, ISO_DOOR_ON_EXIT_BUTTON, 102 * S); /* a second event */
        assert_string_equal(levels(&door), pulse);
        iso_door_handle(&door, ISO_DOOR_ON_OPENED, 102 * S + S / 4);
        assert_int_equal(door.pulse_due_ns, ISO_NEVER_NS);
        assert_string_equal(levels(&door), over);
    }
}

/* A test unlocks the door for half a second, however long the door is unlocked for people. */
static void a_test_is_short(void **state)
{
    (void)state;
    for (int fail = 0; fail < 2; fail++) {
        struct iso_door door = door_in(fail ? &safe : &secure, ISO_DOOR_LOCKED, false);
        assert_true(iso_door_handle(&door, ISO_DOOR_ON_TEST, 100 * S));
        assert_int_equal(iso_door_outputs_of(&door).active[ISO_DOOR_RELAY], fail == 0);
        assert_int_equal(iso_door_due_ns(&door), 100 * S + S / 2);
        assert_false(iso_door_handle(&door, ISO_DOOR_ON_TEST, 100 * S + S / 4)); /* not longer */
        assert_true(iso_door_handle(&door, ISO_DOOR_ON_TIME, 100 * S + S / 2));
        assert_int_equal(door.state, ISO_DOOR_LOCKED);
        assert_int_equal(iso_door_outputs_of(&door).active[ISO_DOOR_RELAY], fail == 1);
        iso_door_handle(&door, ISO_DOOR_ON_TEST, 102 * S);
        iso_door_handle(&door, ISO_DOOR_ON_EXIT_BUTTON, 102 * S); /* people get the full time */
        assert_int_equal(iso_door_due_ns(&door), 106 * S);
    }
}

static void lights_the_face_while_it_works(void **state)
{
    (void)state;
    for (int s = 0; s < ISO_DOOR_FAULT; s++) {
        const struct iso_door door = door_in(&secure, (enum iso_door_state)s, false);
        assert_int_equal(iso_door_outputs_of(&door).active[ISO_DOOR_PROJECTOR],
                         s != ISO_DOOR_STOPPED);
    }
}

static void sounds_while_the_housing_is_open(void **state)
{
    (void)state;
    struct iso_door door = door_in(&secure, ISO_DOOR_LOCKED, false);
    assert_false(iso_door_handle(&door, ISO_DOOR_ON_TAMPER, 100 * S));
    assert_string_equal(levels(&door), "B");
    iso_door_handle(&door, ISO_DOOR_ON_STOP, 101 * S);
    assert_string_equal(levels(&door), "");
    iso_door_handle(&door, ISO_DOOR_ON_START, 102 * S);
    assert_string_equal(levels(&door), "B");
    iso_door_handle(&door, ISO_DOOR_ON_TAMPER_ENDED, 103 * S);
    assert_string_equal(levels(&door), "");
}

static void has_words_for_everything(void **state)
{
    (void)state;
    assert_string_equal(iso_door_state_name(ISO_DOOR_HELD_OPEN), "held-open");
    assert_null(iso_door_state_name(ISO_DOOR_STATES));
    assert_string_equal(iso_door_event_name(ISO_DOOR_ON_TIME), "time");
    assert_null(iso_door_event_name(ISO_DOOR_EVENTS));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(follows_the_table),
        cmocka_unit_test(rests_in_fault_while_one_lasts),
        cmocka_unit_test(starts_at_fault_if_one_lasts),
        cmocka_unit_test(locks_again_in_time),
        cmocka_unit_test(stays_unlocked_for_the_next_one),
        cmocka_unit_test(sounds_when_held_open),
        cmocka_unit_test(shows_a_refusal_for_a_while),
        cmocka_unit_test(switches_by_state),
        cmocka_unit_test(pulses_the_relay),
        cmocka_unit_test(a_test_is_short),
        cmocka_unit_test(lights_the_face_while_it_works),
        cmocka_unit_test(sounds_while_the_housing_is_open),
        cmocka_unit_test(has_words_for_everything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
