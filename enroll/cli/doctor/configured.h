/* Whether `isotherm setup` is still to be run: then nothing starts the daemon. */
#ifndef CLI_DOCTOR_CONFIGURED_H
#define CLI_DOCTOR_CONFIGURED_H

#include <stdbool.h>

#include "enroll/cli/client/daemon.h"
#include "enroll/cli/client/fault.h"

/* False if the bus is the system's and the configuration of its daemon is missing. What is on
 * another bus has been started in another way. */
bool cli_is_configured(const struct cli_bus *bus);

/* If the fault is that there is no daemon, and it is not configured yet: says so instead. */
void cli_explain_no_daemon(const struct cli_bus *bus, enum cli_exit exit, struct cli_fault *fault);

#endif
