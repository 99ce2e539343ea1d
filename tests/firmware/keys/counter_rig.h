/* A state directory with a counter. The counter is a puppet of the test, or that of a software TPM.
 */
#ifndef TESTS_FIRMWARE_KEYS_COUNTER_RIG_H
#define TESTS_FIRMWARE_KEYS_COUNTER_RIG_H

#include "tests/firmware/rigs/puppet_counter.h"
#include "tests/firmware/rigs/state_rig.h"
#include "tests/support/devices/soft_tpm.h"

extern struct puppet_counter counter_rig_puppet;
extern struct soft_tpm counter_rig_tpm;
extern bool counter_rig_with_tpm; /* true: the software TPM; set before the tests */

/* Simulates a kill between the write of the anchor and the increment: no increment takes place. */
extern bool counter_rig_killed;

struct world {
    char *state; /* the directory of the stores */
    void *scratch;
    struct mix_state before; /* the files of the state directory after the set-up */
};

/* cmocka set-up and tear-down: *state is a struct world. */
int counter_rig_setup(void **state);
int counter_rig_teardown(void **state);

/* Opens the counter, as state_rig_counter does. */
int counter_rig_open(struct iso_counter *out, struct iso_fault *fault);

/* Returns the value of the counter. No store may have the counter open during the call. */
uint64_t counter_rig_value(void);

/* Takes the counter's device away, or brings it back. */
void counter_rig_take_away(bool away);

/* Gives the machine another device, whose counter never counted. */
void counter_rig_exchange(void);

/* Asserts that the daemon refuses the stores with this error, this code and these words in one
 * line; or that it opens them. */
void counter_rig_expect_refusal(const struct world *world, int error, enum iso_fault_code code,
                                const char *words);
void counter_rig_expect_open(const struct world *world);

#endif
