/* When the counter of the state is raised, and the effects of a device that fails. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/keys/counter_rig.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

/* ---- when it is raised ---- */

static void records_alone_raise_it_once_an_hour(void **state)
{
    const struct world *world = *state;
    struct iso_components *components = state_rig_open(world->state);
    const int start = counter_rig_puppet.increments;
    for (int i = 0; i < 100; i++) {
        state_rig_append(components, "visit");
    }
    assert_int_equal(counter_rig_puppet.increments, start);
    state_rig_now_ns += 3599 * ISO_NS_PER_S;
    state_rig_append(components, "visit");
    assert_int_equal(counter_rig_puppet.increments, start);
    state_rig_now_ns += ISO_NS_PER_S;
    state_rig_append(components, "visit");
    assert_int_equal(counter_rig_puppet.increments, start + 1);
    state_rig_append(components, "visit");
    assert_int_equal(counter_rig_puppet.increments, start + 1);
    state_rig_close(components);
    assert_int_equal(counter_rig_puppet.increments, start + 2);
}

static void changes_raise_it_at_once(void **state)
{
    const struct world *world = *state;
    static const char *const events[] = {"lockdown", "rotate-keys", "state-accepted"};
    struct iso_components *components = state_rig_open(world->state);
    state_rig_append(components, "gallery"); /* its keys were rotated */
    int expected = counter_rig_puppet.increments;
    state_rig_append(components, "gallery"); /* it is unchanged */
    assert_int_equal(counter_rig_puppet.increments, expected);
    for (size_t i = 0; i < sizeof events / sizeof *events; i++) {
        state_rig_append(components, events[i]);
        assert_int_equal(counter_rig_puppet.increments, ++expected);
    }
    state_rig_append(components, "setting"); /* settings were loaded */
    assert_int_equal(counter_rig_puppet.increments, expected);
    struct iso_audit_record setting = iso_audit_record_of("setting");
    setting.before = "3";
    setting.after = "4";
    assert_int_equal(iso_audit_append(components->audit, &setting, NULL), 0);
    assert_int_equal(counter_rig_puppet.increments, ++expected);
    state_rig_enrol(components);
    assert_int_equal(counter_rig_puppet.increments, ++expected);
    state_rig_close(components);
}

/* An attacker who provokes lock-outs cannot wear out the TPM. */
static void a_lock_out_raises_it_once_in_half_an_hour(void **state)
{
    const struct world *world = *state;
    struct iso_components *components = state_rig_open(world->state);
    const int start = counter_rig_puppet.increments;
    state_rig_append(components, "lockout");
    state_rig_now_ns += 1799 * ISO_NS_PER_S;
    assert_false(iso_state_counter_is_due(components->counter));
    state_rig_append(components, "visit"); /* does not make the increment due */
    assert_int_equal(counter_rig_puppet.increments, start);
    state_rig_now_ns += ISO_NS_PER_S;
    assert_true(iso_state_counter_is_due(components->counter));
    for (int i = 0; i < 10; i++) {
        state_rig_append(components, "lockout");
    }
    assert_int_equal(counter_rig_puppet.increments, start + 1);
    state_rig_close(components);
}

/* The increment fails. The number does not change until an increment succeeds, and then rises
 * again. */
static void a_failure_is_reported_and_tried_again(void **state)
{
    const struct world *world = *state;
    struct iso_fault fault = {.text = ""};
    int error = 0;
    struct iso_components *components = state_rig_open(world->state);
    const uint64_t value = counter_rig_puppet.value;
    assert_false(iso_state_counter_take_news(components->counter, &error, &fault));
    counter_rig_puppet.error = -EIO;
    state_rig_append(components, "lockdown");
    state_rig_append(components, "lockdown");
    assert_true(iso_state_counter_take_news(components->counter, &error, &fault));
    assert_int_equal(error, -EIO);
    assert_non_null(strstr(fault.text, "the puppet"));
    assert_false(iso_state_counter_take_news(components->counter, &error, &fault)); /* once */
    assert_int_equal(counter_rig_puppet.value, value);
    counter_rig_puppet.error = 0;
    state_rig_append(components, "visit"); /* every write of the anchor tries again */
    assert_int_equal(counter_rig_puppet.value, value + 1);
    assert_true(iso_state_counter_take_news(components->counter, &error, &fault));
    assert_int_equal(error, 0);
    state_rig_append(components, "visit"); /* changes during the failure still count */
    assert_int_equal(counter_rig_puppet.value, value + 2);
    state_rig_close(components);
    counter_rig_expect_open(world);
}

static void an_answer_that_is_lost_does_not_count_twice(void **state)
{
    const struct world *world = *state;
    struct iso_components *components = state_rig_open(world->state);
    const uint64_t value = counter_rig_puppet.value;
    counter_rig_puppet.loses_answer = true;
    state_rig_append(components, "lockdown");
    assert_int_equal(counter_rig_puppet.value, value + 1);
    state_rig_append(components, "visit"); /* reads the counter again */
    assert_int_equal(counter_rig_puppet.value, value + 1);
    counter_rig_puppet.loses_answer = false;
    state_rig_append(components, "lockdown");
    assert_int_equal(counter_rig_puppet.value, value + 2);
    state_rig_close(components);
    counter_rig_expect_open(world);
}

/* Anyone who may use the TPM can increment the counter. This must not lock the appliance out for
 * ever. */
static void increments_by_others_are_followed(void **state)
{
    const struct world *world = *state;
    struct iso_components *components = state_rig_open(world->state);
    counter_rig_puppet.value += 5;
    state_rig_append(components, "lockdown");
    state_rig_append(components, "visit");
    state_rig_close(components);
    counter_rig_expect_open(world);
    counter_rig_puppet.value += 5; /* while no daemon ran */
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
}

static void a_counter_that_is_too_large_is_refused(void **state)
{
    const struct world *world = *state;
    counter_rig_puppet.value = ISO_STATE_COUNTER_MOST + 1;
    counter_rig_expect_refusal(world, -ERANGE, ISO_FAULT_COUNTER_UNFIT, "more than can be kept");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, counter_rig_setup, counter_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(records_alone_raise_it_once_an_hour),
        TEST(changes_raise_it_at_once),
        TEST(a_lock_out_raises_it_once_in_half_an_hour),
        TEST(a_failure_is_reported_and_tried_again),
        TEST(an_answer_that_is_lost_does_not_count_twice),
        TEST(increments_by_others_are_followed),
        TEST(a_counter_that_is_too_large_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
