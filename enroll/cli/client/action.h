/* An action in front of the camera (enrol, verify, identify). It claims the daemon's sensor, starts
 * the action, and passes on the status signals up to the last one. In every case it stops the
 * action and releases the sensor. */
#ifndef CLI_CLIENT_ACTION_H
#define CLI_CLIENT_ACTION_H

#include <stdbool.h>
#include <systemd/sd-bus.h>

#include "enroll/cli/client/daemon.h"

struct cli_action {
    const char *start, *stop; /* names of firmware/contract/contract.h */
    const char *signal;       /* the same; NULL: `status` is called for every signal */
    /* Appends the arguments of `start`. Returns 0 or more, or a negative errno. NULL: none. */
    int (*append)(sd_bus_message *call, const void *context);
    /* Reads the answer to `start`. NULL: the answer is empty. */
    void (*answered)(sd_bus_message *reply, void *context);
    /* Called when the action has started, to tell the person in front of the camera what to do. */
    void (*started)(void *context);
    /* Reads such a signal. Returns true if it is the last one or cannot be read. */
    bool (*status)(sd_bus_message *signal, void *context);
    void *context;    /* passed to these functions */
    double timeout_s; /* longest wait for the last status; 0: no limit */
};

/* Runs the action. CLI_EXIT_OK: the last status has come. CLI_EXIT_TIMED_OUT or
 * CLI_EXIT_INTERRUPTED with an empty fault->text: it has not. Other results are faults of
 * cli_daemon_send() or cli_daemon_wait(). */
enum cli_exit cli_action_run(struct cli_daemon *daemon, const struct cli_action *action,
                             struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
