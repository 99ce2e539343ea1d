/* The counter makes the daemon refuse a complete state directory of an earlier time. The tests also
 * check the effects of the counter on the appliance. They run once with a counter of the test, and
 * once with a TPM. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/keys/counter_rig.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

static void accept(const struct world *world, const char *expected)
{
    struct iso_fault why = {.text = ""}, fault = {.text = ""};
    struct iso_components *components = state_rig_new(world->state, &fault);
    assert_non_null(components);
    if (iso_components_accept_stores(components, &why, &fault)) {
        fail_msg("%s", fault.text);
    }
    if (!strstr(why.text, expected)) {
        fail_msg("accepted: %s", why.text);
    }
    state_rig_close(components);
}

/* ---- directories of an earlier time ---- */

static void a_whole_directory_of_an_earlier_time_is_refused(void **state)
{
    const struct world *world = *state;
    for (size_t i = 0; i < state_n_histories; i++) {
        struct mix_state before, after;
        char line[80];
        struct iso_components *components = state_rig_open(world->state);
        state_rig_close(components);
        mix_take(world->state, &before);
        const uint64_t value = counter_rig_value();
        state_rig_play(world->state, state_histories[i].name, &after);
        assert_true(counter_rig_value() > value);
        mix_put_back(world->state, &before);
        (void)snprintf(line, sizeof line, "its counter says %llu, the TPM says %llu",
                       (unsigned long long)value, (unsigned long long)counter_rig_value());
        counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD,
                                   "/audit.log: the state directory is of an earlier time: ");
        counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, line);
        mix_put_back(world->state, &after);
        counter_rig_expect_open(world);
        mix_let_go(&before);
        mix_let_go(&after);
    }
}

/* A start alone is enough, without any other change since then. */
static void a_copy_from_before_the_last_start_is_refused(void **state)
{
    const struct world *world = *state;
    struct mix_state now;
    state_rig_close(state_rig_open(world->state));
    mix_take(world->state, &now);
    mix_put_back(world->state, &world->before);
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
    mix_put_back(world->state, &now);
    counter_rig_expect_open(world);
    mix_let_go(&now);
}

static void every_mixture_is_still_refused(void **state)
{
    const struct world *world = *state;
    struct mix_state after, mixed;
    char names[MIX_FILES_MAX][MIX_NAME_SIZE];
    state_rig_play(world->state, "everything", &after);
    const size_t n = mix_differing(&world->before, &after, names);
    assert_true(n >= 8);
    for (unsigned mask = 0; mask < (1u << n) - 1; mask++) { /* 0: all files are earlier ones */
        mix_states(&world->before, &after, names, n, mask, &mixed);
        struct iso_fault fault = {.text = ""};
        mix_put_back(world->state, &mixed);
        if (!state_rig_try(world->state, &fault) || !strstr(fault.text, world->state)) {
            fail_msg("mixture %#x: %s", mask, fault.text);
        }
    }
    print_message("%u mixtures refused, the whole directory among them\n", (1u << n) - 1);
    mix_let_go(&after);
}

/* Only an appliance in which nobody is enrolled is accepted because of a factory reset. */
static void the_mark_of_a_reset_brings_nobody_back(void **state)
{
    const struct world *world = *state;
    struct mix_state after;
    state_rig_play(world->state, "enrolments", &after);
    mix_put_back(world->state, &world->before);
    scratch_write_text(scratch_path(world->state, "factory-reset.done"), "");
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
    mix_let_go(&after);
}

static int count_accepted(void *context, const char *line)
{
    int *n = context;
    *n += strstr(line, "\"event\":\"state-accepted\"") && strstr(line, "its counter says");
    return 0;
}

static void an_administrator_accepts_an_earlier_directory(void **state)
{
    const struct world *world = *state;
    struct mix_state after;
    int n = 0;
    state_rig_play(world->state, "enrolments", &after);
    mix_put_back(world->state, &world->before);
    accept(world, "is of an earlier time: its counter says");
    counter_rig_expect_open(world);
    accept(world, "");
    struct iso_components *components = state_rig_open(world->state);
    assert_int_equal(iso_audit_read(components->audit, 1, UINT32_MAX, count_accepted, &n), 0);
    assert_int_equal(n, 2);
    state_rig_close(components);
    counter_rig_expect_open(world);
    mix_put_back(world->state, &after); /* since the acceptance, these are the earlier files */
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
    mix_let_go(&after);
}

static void a_new_directory_beside_an_old_counter_has_to_be_accepted(void **state)
{
    const struct world *world = *state;
    const struct mix_state empty = {.n = 0};
    mix_put_back(world->state, &empty);
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD,
                               "is new, or of an earlier time: it has no counter");
    accept(world, "is new, or of an earlier time");
    counter_rig_expect_open(world);
}

/* ---- interruptions ---- */

static void a_kill_before_the_increment_is_caught_up(void **state)
{
    const struct world *world = *state;
    struct mix_state ahead;
    const uint64_t value = counter_rig_value();
    struct iso_components *components = state_rig_open(world->state);
    counter_rig_killed = true;
    state_rig_enrol(components);
    state_rig_append(components, "visit");
    state_rig_close(components);
    counter_rig_killed = false;
    mix_take(world->state, &ahead);
    assert_int_equal(counter_rig_value(), value + 1); /* from the start alone */
    counter_rig_expect_open(world);                   /* the files are one ahead */
    state_rig_close(state_rig_open(world->state));    /* the end counts, too */
    assert_int_equal(counter_rig_value(), value + 3);
    counter_rig_expect_open(world);
    mix_put_back(world->state, &ahead);
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
    mix_let_go(&ahead);
}

static void a_device_that_is_gone_is_refused(void **state)
{
    const struct world *world = *state;
    counter_rig_take_away(true);
    counter_rig_expect_refusal(world, -EIO, ISO_FAULT_TPM_FAILED,
                               counter_rig_with_tpm ? "cannot be reached" : "the puppet is away");
    counter_rig_take_away(false);
    counter_rig_expect_open(world);
}

static void another_device_has_to_be_accepted(void **state)
{
    const struct world *world = *state;
    const uint64_t value = counter_rig_value();
    char line[64];
    (void)snprintf(line, sizeof line, "it has to be %llu", (unsigned long long)value);
    counter_rig_exchange();
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_COUNTER_GONE,
                               "the counter of the state is gone from the TPM");
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_COUNTER_GONE, line);
    accept(world, "is gone from the TPM");
    counter_rig_expect_open(world);
    state_rig_close(state_rig_open(world->state));
    counter_rig_expect_open(world);
    assert_true(counter_rig_value() < value);
}

static void a_counter_that_is_behind_is_another_one(void **state)
{
    const struct world *world = *state;
    counter_rig_exchange();
    state_rig_counter = NULL;
    struct mix_state empty = {.n = 0}, old;
    mix_take(world->state, &old);
    mix_put_back(world->state, &empty);
    state_rig_counter = counter_rig_open;
    state_rig_close(state_rig_open(world->state)); /* begins to use the counter */
    mix_put_back(world->state, &old);
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_COUNTER_OTHER,
                               "belongs to another counter");
    accept(world, "belongs to another counter");
    counter_rig_expect_open(world);
    mix_let_go(&old);
}

/* ---- without a counter ---- */

static void the_number_stays_while_no_counter_is_configured(void **state)
{
    const struct world *world = *state;
    struct mix_state after;
    state_rig_counter = NULL;
    state_rig_play(world->state, "everything", &after);
    state_rig_counter = counter_rig_open;
    counter_rig_expect_open(world);
    mix_let_go(&after);
}

static void a_state_without_a_number_gets_one(void **state)
{
    const struct world *world = *state;
    const struct mix_state empty = {.n = 0};
    struct mix_state after;
    counter_rig_exchange();
    mix_put_back(world->state, &empty);
    state_rig_counter = NULL;
    state_rig_play(world->state, "enrolments", &after);
    state_rig_counter = counter_rig_open;
    counter_rig_expect_open(world);
    state_rig_close(state_rig_open(world->state));
    assert_int_equal(counter_rig_value(), 3); /* the creation, the start, the end */
    mix_put_back(world->state, &after);
    counter_rig_expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "has no counter");
    mix_let_go(&after);
}

/* ---- the thread ---- */

static void wait_for_value(struct iso_state_counter *counter, uint32_t number)
{
    for (int i = 0; i < 3000 && !iso_state_counter_is_due(counter); i++) {
        iso_state_counter_changed(
            counter, ISO_STATE_ADMINISTRATOR); /* due as soon as no increment is under way */
        (void)usleep(10000);
    }
    assert_int_equal(iso_state_counter_next(counter), number + 1);
}

static void a_thread_counts(void **state)
{
    const struct world *world = *state;
    struct iso_fault fault = {.text = ""};
    struct iso_components *components = state_rig_new(world->state, &fault);
    assert_int_equal(iso_components_open_stores(components, &fault), 0);
    assert_int_equal(iso_components_begin_counter(components, true, &fault), 0);
    const uint32_t number = iso_state_counter_next(components->counter);
    state_rig_append(components, "lockdown");
    wait_for_value(components->counter, number + 1);
    counter_rig_killed = true; /* only the thread tries again */
    state_rig_append(components, "lockdown");
    (void)usleep(50000);
    assert_false(iso_state_counter_is_due(components->counter));
    counter_rig_killed = false;
    wait_for_value(components->counter, number + 2);
    state_rig_close(components);
    assert_int_equal(counter_rig_value(), number + 3); /* the end counts, too */
    counter_rig_expect_open(world);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, counter_rig_setup, counter_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_whole_directory_of_an_earlier_time_is_refused),
        TEST(a_copy_from_before_the_last_start_is_refused),
        TEST(every_mixture_is_still_refused),
        TEST(the_mark_of_a_reset_brings_nobody_back),
        TEST(an_administrator_accepts_an_earlier_directory),
        TEST(a_new_directory_beside_an_old_counter_has_to_be_accepted),
        TEST(a_kill_before_the_increment_is_caught_up),
        TEST(a_device_that_is_gone_is_refused),
        TEST(another_device_has_to_be_accepted),
        TEST(a_counter_that_is_behind_is_another_one),
        TEST(the_number_stays_while_no_counter_is_configured),
        TEST(a_state_without_a_number_gets_one),
        TEST(a_thread_counts),
    };
    counter_rig_with_tpm = getenv("ISOTHERM_TEST_TPM") != NULL;
    if (!counter_rig_with_tpm) {
        return cmocka_run_group_tests(tests, NULL, NULL);
    }
    void *directory = NULL;
    struct soft_tpm first;
    assert_int_equal(scratch_setup(&directory), 0);
    const bool there = soft_tpm_start(&first, directory);
    soft_tpm_off(&first);
    assert_int_equal(scratch_teardown(&directory), 0);
    return there ? cmocka_run_group_tests(tests, NULL, NULL) : TEST_SKIPPED;
}
