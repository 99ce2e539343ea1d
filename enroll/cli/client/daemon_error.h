/* The errors of the bus and of the daemon in plain words. */
#ifndef CLI_CLIENT_DAEMON_ERROR_H
#define CLI_CLIENT_DAEMON_ERROR_H

#include <systemd/sd-bus.h>

#include "enroll/cli/client/fault.h"

/* Makes a fault of a failed call of `method`. sd_bus_call() has filled in `error`, which may be
 * empty, and has returned `result`, a negative errno. cli_daemon_send() lists the faults. */
enum cli_exit cli_daemon_error(const sd_bus_error *error, int result, const char *method,
                               struct cli_fault *fault);

#endif
