/* Whether the daemon is configured. Without a configuration nothing starts it; `isotherm setup`
 * writes one. */
#ifndef CLI_DOCTOR_CONFIGURED_H
#define CLI_DOCTOR_CONFIGURED_H

#include <stdbool.h>

#include "enroll/cli/client/daemon.h"
#include "enroll/cli/client/fault.h"

/* False if the bus is the system's and the configuration of its daemon is missing. A daemon on
 * another bus has its own configuration. */
bool cli_is_configured(const struct cli_bus *bus);

/* If the fault is that there is no daemon, and the daemon is not configured, the fault says this
 * instead. */
void cli_explain_no_daemon(const struct cli_bus *bus, enum cli_exit exit, struct cli_fault *fault);

#endif
