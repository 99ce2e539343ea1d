/* A state directory with a counter: one of the test's, or that of a software TPM. */
#ifndef TESTS_FIRMWARE_KEYS_COUNTER_RIG_H
#define TESTS_FIRMWARE_KEYS_COUNTER_RIG_H

#include "tests/firmware/rigs/puppet_counter.h"
#include "tests/firmware/rigs/state_rig.h"
#include "tests/support/devices/soft_tpm.h"

extern struct puppet_counter counter_rig_puppet;
extern struct soft_tpm counter_rig_tpm;
extern bool counter_rig_with_tpm; /* which of the two it is; set before the tests */

/* A kill between the write of the anchor and the increment: the increments do not take place. */
extern bool counter_rig_killed;

struct world {
    char *state; /* directory of the stores */
    void *scratch;
    struct mix_state before;
};

/* cmocka set-up and tear-down: *state is a struct world. */
int counter_rig_setup(void **state);
int counter_rig_teardown(void **state);

/* Opens the device, as state_rig_counter does. */
int counter_rig_open(struct iso_counter *out, struct iso_fault *fault);

/* The number of the device; nobody else may have it meanwhile. */
uint64_t counter_rig_value(void);

/* The device is away, or back. */
void counter_rig_take_away(bool away);

/* The machine gets another device, which never counted. */
void counter_rig_exchange(void);

/* The stores are refused with this error, code and words, in one line; or they can be opened. */
void counter_rig_expect_refusal(const struct world *world, int error, enum iso_fault_code code,
                                const char *words);
void counter_rig_expect_open(const struct world *world);

#endif
