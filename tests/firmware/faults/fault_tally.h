/* Prints the last line of every program that tries faults. All these programs share it, so that a
 * reader and tests/gate/summary.sh find it. */
#ifndef TESTS_FIRMWARE_FAULTS_FAULT_TALLY_H
#define TESTS_FIRMWARE_FAULTS_FAULT_TALLY_H

#include <stdio.h>

/* Prints "kills: 1000 faults tried in 8213 operations, 0 violations" on standard output.
 * `operations` is how often a test made the appliance or its stores do something; `violations` is
 * how often a rule did not hold. */
static inline void fault_tally_print(const char *what, long faults, long operations,
                                     long violations)
{
    printf("%s: %ld %s tried in %ld %s, %ld %s\n", what, faults, faults == 1 ? "fault" : "faults",
           operations, operations == 1 ? "operation" : "operations", violations,
           violations == 1 ? "violation" : "violations");
    (void)fflush(stdout);
}

#endif
