/* An action in front of the camera (enrol, verify, identify): it claims the daemon's sensor, starts
 * the action, passes on the status signals up to the last one, and releases everything in every
 * case. */
#ifndef CLI_CLIENT_ACTION_H
#define CLI_CLIENT_ACTION_H

#include <stdbool.h>
#include <systemd/sd-bus.h>

#include "enroll/cli/client/daemon.h"

struct cli_action {
    const char *start, *stop, *signal; /* names of firmware/contract/contract.h */
    /* Appends the arguments of `start`; 0 or a negative errno. NULL if there are none. */
    int (*append)(sd_bus_message *call, const void *context);
    /* Takes the answer to `start`; NULL if the answer is empty. */
    void (*answered)(sd_bus_message *reply, void *context);
    /* Called when the action has started: the time to speak to the person in front of the camera.
     */
    void (*started)(void *context);
    /* Takes a status signal; true if it is the last one, or cannot be read. */
    bool (*status)(sd_bus_message *signal, void *context);
    void *context;
    double timeout_s;
};

/* CLI_EXIT_OK: the last status has come. CLI_EXIT_TIMED_OUT and CLI_EXIT_INTERRUPTED: it has not,
 * fault->text is empty. Else a fault of cli_daemon_send() or cli_daemon_wait(). */
enum cli_exit cli_action_run(struct cli_daemon *daemon, const struct cli_action *action,
                             struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
