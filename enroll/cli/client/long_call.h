/* A call of the daemon that may take long: people written to a file or read from one, keys rotated,
 * the log verified. */
#ifndef CLI_CLIENT_LONG_CALL_H
#define CLI_CLIENT_LONG_CALL_H

#include "enroll/cli/client/daemon.h"

/* As cli_daemon_send, and shows on standard error how far the daemon is with it: `what` it does,
 * the share that is done and the time that is left, from the Progress signals that it sends
 * meanwhile. Without such a signal (the call is short, or the daemon is of a version that sends
 * none) only the time that has passed is shown. The daemon has ten minutes for the answer or the
 * next signal. */
enum cli_exit cli_long_call(struct cli_daemon *daemon, sd_bus_message *call, const char *what,
                            sd_bus_message **reply, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
