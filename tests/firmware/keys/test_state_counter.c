/* A whole state directory of an earlier time is refused, by a counter; what the counter can do to
 * the appliance, and when it is raised. Once with a counter of the test's, and once with a TPM. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/counter/tpm2_counter.h"
#include "tests/firmware/rigs/puppet_counter.h"
#include "tests/firmware/rigs/state_rig.h"
#include "tests/support/devices/soft_tpm.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

/* ---- the devices ---- */

static struct puppet_counter puppet;
static struct soft_tpm tpm;
static bool with_tpm;

/* A kill between the write of the anchor and the increment: the increments do not take place. */
static bool killed;
static struct iso_counter device;

static int cut_read(void *self, uint64_t *value, struct iso_fault *fault)
{
    (void)self;
    return device.ops->read(device.self, value, fault);
}

static int cut_define(void *self, uint64_t *value, struct iso_fault *fault)
{
    (void)self;
    return device.ops->define(device.self, value, fault);
}

static int cut_increment(void *self, uint64_t *value, struct iso_fault *fault)
{
    (void)self;
    return killed ? iso_fault_set(fault, -EIO, "killed")
                  : device.ops->increment(device.self, value, fault);
}

static void cut_close(void *self)
{
    (void)self;
    iso_counter_close(&device);
}

static int open_device(struct iso_counter *out, struct iso_fault *fault)
{
    static const struct iso_counter_ops ops = {"cut", cut_read, cut_define, cut_increment,
                                               cut_close};
    int error = with_tpm       ? iso_tpm2_counter_open(tpm.tcti, 0x01804953, &device, fault)
                : puppet.error ? iso_fault_set_code(fault, ISO_FAULT_TPM_FAILED, puppet.error,
                                                    "the puppet is away")
                               : 0;
    if (!error && !with_tpm) {
        device = puppet_counter(&puppet);
    }
    *out = (struct iso_counter){.ops = &ops};
    return error;
}

/* Nobody else has the device meanwhile. */
static uint64_t value_of_device(void)
{
    struct iso_fault fault = {.text = ""};
    struct iso_counter counter = {0};
    uint64_t value = 0;
    assert_int_equal(open_device(&counter, &fault), 0);
    assert_int_equal(counter.ops->read(counter.self, &value, &fault), 0);
    iso_counter_close(&counter);
    return value;
}

static void take_device_away(bool away)
{
    puppet.error = away ? -EIO : 0;
    if (with_tpm && away) {
        soft_tpm_off(&tpm);
    } else if (with_tpm) {
        soft_tpm_on(&tpm);
    }
}

/* The machine gets another one, which never counted. */
static void exchange_device(void)
{
    puppet = (struct puppet_counter){0};
    if (with_tpm) {
        soft_tpm_replace(&tpm);
    }
}

/* ---- the world ---- */

struct world {
    char *state; /* directory of the stores */
    void *scratch;
    struct mix_state before;
};

static int setup(void **state)
{
    static struct world world;
    if (scratch_setup(&world.scratch)) {
        return -1;
    }
    const char *path = scratch_path(world.scratch, "state");
    scratch_mkdir(path);
    world.state = strdup(path);
    puppet = (struct puppet_counter){0};
    killed = false;
    state_rig_now_ns = 0;
    state_rig_faces = 0;
    state_rig_counter = open_device;
    if (with_tpm) {
        assert_true(soft_tpm_start(&tpm, world.scratch));
    }
    state_rig_begin(world.state, &world.before);
    *state = &world;
    return 0;
}

static int teardown(void **state)
{
    struct world *world = *state;
    if (with_tpm) {
        soft_tpm_off(&tpm);
    }
    mix_let_go(&world->before);
    free(world->state);
    return scratch_teardown(&world->scratch);
}

static void expect_refusal(const struct world *world, int error, enum iso_fault_code code,
                           const char *words)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(state_rig_try(world->state, &fault), error);
    if (!strstr(fault.text, words) || strchr(fault.text, '\n')) {
        fail_msg("'%s' is not in one line: %s", words, fault.text);
    }
    assert_int_equal(fault.code, code);
}

static void expect_open(const struct world *world)
{
    struct iso_fault fault = {.text = ""};
    if (state_rig_try(world->state, &fault)) {
        fail_msg("%s", fault.text);
    }
}

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
        const uint64_t value = value_of_device();
        state_rig_play(world->state, state_histories[i].name, &after);
        assert_true(value_of_device() > value);
        mix_put_back(world->state, &before);
        (void)snprintf(line, sizeof line, "its counter says %llu, the TPM says %llu",
                       (unsigned long long)value, (unsigned long long)value_of_device());
        expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD,
                       "/audit.log: the state directory is of an earlier time: ");
        expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, line);
        mix_put_back(world->state, &after);
        expect_open(world);
        mix_let_go(&before);
        mix_let_go(&after);
    }
}

/* A start is enough: nothing else need have happened since. */
static void a_copy_from_before_the_last_start_is_refused(void **state)
{
    const struct world *world = *state;
    struct mix_state now;
    state_rig_close(state_rig_open(world->state));
    mix_take(world->state, &now);
    mix_put_back(world->state, &world->before);
    expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
    mix_put_back(world->state, &now);
    expect_open(world);
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
    for (unsigned mask = 0; mask < (1u << n) - 1; mask++) { /* 0: all files are of before */
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
    expect_open(world);
    accept(world, "");
    struct iso_components *components = state_rig_open(world->state);
    assert_int_equal(iso_audit_read(components->audit, 1, UINT32_MAX, count_accepted, &n), 0);
    assert_int_equal(n, 2);
    state_rig_close(components);
    expect_open(world);
    mix_put_back(world->state, &after); /* what was not chosen is of an earlier time now */
    expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
    mix_let_go(&after);
}

static void a_new_directory_beside_an_old_counter_has_to_be_accepted(void **state)
{
    const struct world *world = *state;
    const struct mix_state empty = {.n = 0};
    mix_put_back(world->state, &empty);
    expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD,
                   "is new, or of an earlier time: it has no counter");
    accept(world, "is new, or of an earlier time");
    expect_open(world);
}

/* ---- interruptions ---- */

static void a_kill_before_the_increment_is_caught_up(void **state)
{
    const struct world *world = *state;
    struct mix_state ahead;
    const uint64_t value = value_of_device();
    struct iso_components *components = state_rig_open(world->state);
    killed = true;
    state_rig_enrol(components);
    state_rig_append(components, "visit");
    state_rig_close(components);
    killed = false;
    mix_take(world->state, &ahead);
    assert_int_equal(value_of_device(), value + 1); /* of the start alone */
    expect_open(world);                             /* one ahead */
    state_rig_close(state_rig_open(world->state));  /* it is caught up, and the end counts, too */
    assert_int_equal(value_of_device(), value + 3);
    expect_open(world);
    mix_put_back(world->state, &ahead);
    expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
    mix_let_go(&ahead);
}

static void a_device_that_is_gone_is_refused(void **state)
{
    const struct world *world = *state;
    take_device_away(true);
    expect_refusal(world, -EIO, ISO_FAULT_TPM_FAILED,
                   with_tpm ? "cannot be reached" : "the puppet is away");
    take_device_away(false);
    expect_open(world);
}

static void another_device_has_to_be_accepted(void **state)
{
    const struct world *world = *state;
    const uint64_t value = value_of_device();
    char line[64];
    (void)snprintf(line, sizeof line, "it has to be %llu", (unsigned long long)value);
    exchange_device();
    expect_refusal(world, -ESTALE, ISO_FAULT_COUNTER_GONE,
                   "the counter of the state is gone from the TPM");
    expect_refusal(world, -ESTALE, ISO_FAULT_COUNTER_GONE, line);
    accept(world, "is gone from the TPM");
    expect_open(world);
    state_rig_close(state_rig_open(world->state));
    expect_open(world);
    assert_true(value_of_device() < value);
}

static void a_counter_that_is_behind_is_another_one(void **state)
{
    const struct world *world = *state;
    exchange_device();
    state_rig_counter = NULL;
    struct mix_state empty = {.n = 0}, old;
    mix_take(world->state, &old);
    mix_put_back(world->state, &empty);
    state_rig_counter = open_device;
    state_rig_close(state_rig_open(world->state)); /* begins to count */
    mix_put_back(world->state, &old);
    expect_refusal(world, -ESTALE, ISO_FAULT_COUNTER_OTHER, "belongs to another counter");
    accept(world, "belongs to another counter");
    expect_open(world);
    mix_let_go(&old);
}

/* ---- without a counter ---- */

static void the_number_stays_while_no_counter_is_configured(void **state)
{
    const struct world *world = *state;
    struct mix_state after;
    state_rig_counter = NULL;
    state_rig_play(world->state, "everything", &after);
    state_rig_counter = open_device;
    expect_open(world);
    mix_let_go(&after);
}

static void a_state_without_a_number_gets_one(void **state)
{
    const struct world *world = *state;
    const struct mix_state empty = {.n = 0};
    struct mix_state after;
    exchange_device();
    mix_put_back(world->state, &empty);
    state_rig_counter = NULL;
    state_rig_play(world->state, "enrolments", &after);
    state_rig_counter = open_device;
    expect_open(world);
    state_rig_close(state_rig_open(world->state));
    assert_int_equal(value_of_device(), 3); /* made, the start, the end */
    mix_put_back(world->state, &after);
    expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "has no counter");
    mix_let_go(&after);
}

/* ---- when it is raised ---- */

static void records_alone_raise_it_once_an_hour(void **state)
{
    const struct world *world = *state;
    struct iso_components *components = state_rig_open(world->state);
    const int start = puppet.increments;
    for (int i = 0; i < 100; i++) {
        state_rig_append(components, "visit");
    }
    assert_int_equal(puppet.increments, start);
    state_rig_now_ns += 3599 * ISO_NS_PER_S;
    state_rig_append(components, "visit");
    assert_int_equal(puppet.increments, start);
    state_rig_now_ns += ISO_NS_PER_S;
    state_rig_append(components, "visit");
    assert_int_equal(puppet.increments, start + 1);
    state_rig_append(components, "visit");
    assert_int_equal(puppet.increments, start + 1);
    state_rig_close(components);
    assert_int_equal(puppet.increments, start + 2);
}

static void changes_raise_it_at_once(void **state)
{
    const struct world *world = *state;
    static const char *const events[] = {"lockdown", "rotate-keys", "state-accepted"};
    struct iso_components *components = state_rig_open(world->state);
    state_rig_append(components, "gallery"); /* its keys were rotated */
    int expected = puppet.increments;
    state_rig_append(components, "gallery"); /* as it was */
    assert_int_equal(puppet.increments, expected);
    for (size_t i = 0; i < sizeof events / sizeof *events; i++) {
        state_rig_append(components, events[i]);
        assert_int_equal(puppet.increments, ++expected);
    }
    state_rig_enrol(components);
    assert_int_equal(puppet.increments, ++expected);
    state_rig_close(components);
}

/* Whoever provokes lock-outs does not wear out the TPM. */
static void a_lock_out_raises_it_once_in_half_an_hour(void **state)
{
    const struct world *world = *state;
    struct iso_components *components = state_rig_open(world->state);
    const int start = puppet.increments;
    state_rig_append(components, "lockout");
    state_rig_now_ns += 1799 * ISO_NS_PER_S;
    assert_false(iso_state_counter_is_due(components->counter));
    state_rig_append(components, "visit"); /* which might wait for longer */
    assert_int_equal(puppet.increments, start);
    state_rig_now_ns += ISO_NS_PER_S;
    assert_true(iso_state_counter_is_due(components->counter));
    for (int i = 0; i < 10; i++) {
        state_rig_append(components, "lockout");
    }
    assert_int_equal(puppet.increments, start + 1);
    state_rig_close(components);
}

/* The increment fails; the number stands still until it succeeds, and then rises again. */
static void a_failure_is_told_and_tried_again(void **state)
{
    const struct world *world = *state;
    struct iso_fault fault = {.text = ""};
    int error = 0;
    struct iso_components *components = state_rig_open(world->state);
    const uint64_t value = puppet.value;
    assert_false(iso_state_counter_take_news(components->counter, &error, &fault));
    puppet.error = -EIO;
    state_rig_append(components, "lockdown");
    state_rig_append(components, "lockdown");
    assert_true(iso_state_counter_take_news(components->counter, &error, &fault));
    assert_int_equal(error, -EIO);
    assert_non_null(strstr(fault.text, "the puppet"));
    assert_false(iso_state_counter_take_news(components->counter, &error, &fault)); /* told once */
    assert_int_equal(puppet.value, value);
    puppet.error = 0;
    state_rig_append(components, "visit"); /* with any anchor */
    assert_int_equal(puppet.value, value + 1);
    assert_true(iso_state_counter_take_news(components->counter, &error, &fault));
    assert_int_equal(error, 0);
    state_rig_append(components, "visit"); /* what changed during the failure is owed still */
    assert_int_equal(puppet.value, value + 2);
    state_rig_close(components);
    expect_open(world);
}

static void an_answer_that_is_lost_does_not_count_twice(void **state)
{
    const struct world *world = *state;
    struct iso_components *components = state_rig_open(world->state);
    const uint64_t value = puppet.value;
    puppet.loses_answer = true;
    state_rig_append(components, "lockdown");
    assert_int_equal(puppet.value, value + 1);
    state_rig_append(components, "visit"); /* asks anew */
    assert_int_equal(puppet.value, value + 1);
    puppet.loses_answer = false;
    state_rig_append(components, "lockdown");
    assert_int_equal(puppet.value, value + 2);
    state_rig_close(components);
    expect_open(world);
}

/* Whoever may use the TPM can count: that is not to lock the appliance out for good. */
static void somebody_else_who_counts_is_followed(void **state)
{
    const struct world *world = *state;
    struct iso_components *components = state_rig_open(world->state);
    puppet.value += 5;
    state_rig_append(components, "lockdown");
    state_rig_append(components, "visit");
    state_rig_close(components);
    expect_open(world);
    puppet.value += 5; /* while nobody was there to follow */
    expect_refusal(world, -ESTALE, ISO_FAULT_STATE_OLD, "is of an earlier time");
}

static void a_counter_that_is_too_large_is_refused(void **state)
{
    const struct world *world = *state;
    puppet.value = ISO_STATE_COUNTER_MOST + 1;
    expect_refusal(world, -ERANGE, ISO_FAULT_COUNTER_UNFIT, "more than can be kept");
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
    killed = true; /* tried again by the thread alone */
    state_rig_append(components, "lockdown");
    (void)usleep(50000);
    assert_false(iso_state_counter_is_due(components->counter));
    killed = false;
    wait_for_value(components->counter, number + 2);
    state_rig_close(components);
    assert_int_equal(value_of_device(), number + 3); /* the end counts, too */
    expect_open(world);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
#define BOTH                                                                                      \
    TEST(a_whole_directory_of_an_earlier_time_is_refused),                                        \
        TEST(a_copy_from_before_the_last_start_is_refused), TEST(every_mixture_is_still_refused), \
        TEST(an_administrator_accepts_an_earlier_directory),                                      \
        TEST(a_new_directory_beside_an_old_counter_has_to_be_accepted),                           \
        TEST(a_kill_before_the_increment_is_caught_up), TEST(a_device_that_is_gone_is_refused),   \
        TEST(another_device_has_to_be_accepted), TEST(a_counter_that_is_behind_is_another_one),   \
        TEST(the_number_stays_while_no_counter_is_configured),                                    \
        TEST(a_state_without_a_number_gets_one), TEST(a_thread_counts)
    const struct CMUnitTest with_puppet[] = {
        BOTH,
        TEST(records_alone_raise_it_once_an_hour),
        TEST(changes_raise_it_at_once),
        TEST(a_lock_out_raises_it_once_in_half_an_hour),
        TEST(a_failure_is_told_and_tried_again),
        TEST(an_answer_that_is_lost_does_not_count_twice),
        TEST(somebody_else_who_counts_is_followed),
        TEST(a_counter_that_is_too_large_is_refused),
    };
    const struct CMUnitTest with_swtpm[] = {BOTH};
    with_tpm = getenv("ISOTHERM_TEST_TPM") != NULL;
    if (!with_tpm) {
        return cmocka_run_group_tests(with_puppet, NULL, NULL);
    }
    void *directory = NULL;
    struct soft_tpm first;
    assert_int_equal(scratch_setup(&directory), 0);
    const bool there = soft_tpm_start(&first, directory);
    soft_tpm_off(&first);
    assert_int_equal(scratch_teardown(&directory), 0);
    return there ? cmocka_run_group_tests(with_swtpm, NULL, NULL) : TEST_SKIPPED;
}
