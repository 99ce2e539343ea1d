/* The errors of the bus and of the daemon in plain words. */
#ifndef CLI_CLIENT_DAEMON_ERROR_H
#define CLI_CLIENT_DAEMON_ERROR_H

#include <systemd/sd-bus.h>

#include "enroll/cli/client/fault.h"

/* Translates a failed call: `error` as filled in by sd_bus_call() (it may be empty), `result` its
 * negative errno, `method` what was called. See cli_daemon_send() for the outcomes. */
enum cli_exit cli_daemon_error(const sd_bus_error *error, int result, const char *method,
                               struct cli_fault *fault);

#endif
