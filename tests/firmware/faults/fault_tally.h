/* The last line of every program that tries faults, the same for all of them, so that a person and
 * tests/gate/summary.sh find it. */
#ifndef TESTS_FIRMWARE_FAULTS_FAULT_TALLY_H
#define TESTS_FIRMWARE_FAULTS_FAULT_TALLY_H

#include <stdio.h>

/* "kills: 1000 faults tried in 8213 operations, 0 violations" on standard output. `operations`
 * is how often a test asked the appliance or its stores to do something; `violations` is how often
 * a rule did not hold. */
static inline void fault_tally_print(const char *what, long faults, long operations,
                                     long violations)
{
    printf("%s: %ld %s tried in %ld %s, %ld %s\n", what, faults, faults == 1 ? "fault" : "faults",
           operations, operations == 1 ? "operation" : "operations", violations,
           violations == 1 ? "violation" : "violations");
    (void)fflush(stdout);
}

#endif
