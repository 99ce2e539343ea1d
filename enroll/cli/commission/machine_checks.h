/* The items of the checklist that the machine checks itself. */
#ifndef CLI_COMMISSION_MACHINE_CHECKS_H
#define CLI_COMMISSION_MACHINE_CHECKS_H

#include <stdio.h>

#include "enroll/cli/client/bus.h"
#include "enroll/cli/client/daemon.h"
#include "enroll/cli/commission/results.h"

/* Checks all of them, but not the relay, and prints each result. It takes some seconds, because
 * frames are counted. Faults of cli_daemon_send(): there is no daemon, or this user may not verify
 * the audit log; and CLI_EXIT_INTERRUPTED. */
enum cli_exit cli_machine_checks(const struct cli_bus *bus, struct cli_daemon *daemon, FILE *out,
                                 struct cli_check_results *results, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Switches the relay, and stores whether that could be done. */
void cli_machine_check_relay(struct cli_daemon *daemon, struct cli_result_of_check *result);

#endif
