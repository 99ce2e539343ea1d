/* Calls of the daemon that may take long: export, import, rotation of keys, verification of the
 * log. */
#ifndef CLI_CLIENT_LONG_CALL_H
#define CLI_CLIENT_LONG_CALL_H

#include "enroll/cli/client/daemon.h"

/* The same as cli_daemon_send, but shows the progress of the daemon on standard error: `what` it
 * does, the share that is done and the remaining time, from the Progress signals of the daemon.
 * Without such a signal (the call is short, or an older daemon sends none) only the time that has
 * passed is shown. The daemon has ten minutes for the answer or the next signal. */
enum cli_exit cli_long_call(struct cli_daemon *daemon, sd_bus_message *call, const char *what,
                            sd_bus_message **reply, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
