#include "tests/firmware/keys/counter_rig.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/counter/tpm2_counter.h"
#include "tests/support/scratch.h"

struct puppet_counter counter_rig_puppet;
struct soft_tpm counter_rig_tpm;
bool counter_rig_with_tpm;

bool counter_rig_killed;
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
    return counter_rig_killed ? iso_fault_set(fault, -EIO, "killed")
                              : device.ops->increment(device.self, value, fault);
}

static void cut_close(void *self)
{
    (void)self;
    iso_counter_close(&device);
}

int counter_rig_open(struct iso_counter *out, struct iso_fault *fault)
{
    static const struct iso_counter_ops ops = {"cut", cut_read, cut_define, cut_increment,
                                               cut_close};
    int error = 0;
    if (counter_rig_with_tpm) {
        error = iso_tpm2_counter_open(counter_rig_tpm.tcti, 0x01804953, &device, fault);
    } else if (counter_rig_puppet.error) {
        error = iso_fault_set_code(fault, ISO_FAULT_TPM_FAILED, counter_rig_puppet.error,
                                   "the puppet is away");
    } else {
        device = puppet_counter(&counter_rig_puppet);
    }
    *out = (struct iso_counter){.ops = &ops};
    return error;
}

uint64_t counter_rig_value(void)
{
    struct iso_fault fault = {.text = ""};
    struct iso_counter counter = {0};
    uint64_t value = 0;
    assert_int_equal(counter_rig_open(&counter, &fault), 0);
    assert_int_equal(counter.ops->read(counter.self, &value, &fault), 0);
    iso_counter_close(&counter);
    return value;
}

void counter_rig_take_away(bool away)
{
    counter_rig_puppet.error = away ? -EIO : 0;
    if (counter_rig_with_tpm && away) {
        soft_tpm_off(&counter_rig_tpm);
    } else if (counter_rig_with_tpm) {
        soft_tpm_on(&counter_rig_tpm);
    }
}

void counter_rig_exchange(void)
{
    counter_rig_puppet = (struct puppet_counter){0};
    if (counter_rig_with_tpm) {
        soft_tpm_replace(&counter_rig_tpm);
    }
}

int counter_rig_setup(void **state)
{
    static struct world world;
    if (scratch_setup(&world.scratch)) {
        return -1;
    }
    const char *path = scratch_path(world.scratch, "state");
    scratch_mkdir(path);
    world.state = strdup(path);
    counter_rig_puppet = (struct puppet_counter){0};
    counter_rig_killed = false;
    state_rig_now_ns = 0;
    state_rig_faces = 0;
    state_rig_counter = counter_rig_open;
    if (counter_rig_with_tpm) {
        assert_true(soft_tpm_start(&counter_rig_tpm, world.scratch));
    }
    state_rig_begin(world.state, &world.before);
    *state = &world;
    return 0;
}

int counter_rig_teardown(void **state)
{
    struct world *world = *state;
    if (counter_rig_with_tpm) {
        soft_tpm_off(&counter_rig_tpm);
    }
    mix_let_go(&world->before);
    free(world->state);
    return scratch_teardown(&world->scratch);
}

void counter_rig_expect_refusal(const struct world *world, int error, enum iso_fault_code code,
                                const char *words)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(state_rig_try(world->state, &fault), error);
    if (!strstr(fault.text, words) || strchr(fault.text, '\n')) {
        fail_msg("'%s' is not in one line: %s", words, fault.text);
    }
    assert_int_equal(fault.code, code);
}

void counter_rig_expect_open(const struct world *world)
{
    struct iso_fault fault = {.text = ""};
    if (state_rig_try(world->state, &fault)) {
        fail_msg("%s", fault.text);
    }
}
