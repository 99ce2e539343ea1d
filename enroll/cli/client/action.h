/* An action in front of the camera (enrol, verify, identify): the daemon's sensor is claimed, the
 * action started, its status signals are handed on until one is the last, and everything is
 * released again, whatever happened. */
#ifndef CLI_CLIENT_ACTION_H
#define CLI_CLIENT_ACTION_H

#include <stdbool.h>
#include <systemd/sd-bus.h>

#include "enroll/cli/client/daemon.h"

struct cli_action {
    const char *start, *stop, *signal; /* names of firmware/contract/contract.h */
    /* Appends the arguments of `start`; 0 or a negative errno. NULL if there are none. */
    int (*append)(sd_bus_message *call, const void *context);
    /* Takes the answer to `start`; NULL if it says nothing. */
    void (*answered)(sd_bus_message *reply, void *context);
    /* The camera is ours and looks: the time to speak to the person before it. */
    void (*started)(void *context);
    /* Takes a status signal; true when it was the last one, or when it is not understood. */
    bool (*status)(sd_bus_message *signal, void *context);
    void *context;
    double timeout_s;
};

/* CLI_EXIT_OK: the last status has come. CLI_EXIT_TIMED_OUT and CLI_EXIT_INTERRUPTED: it has not,
 * fault->text is empty. Else a fault of cli_daemon_send() or cli_daemon_wait(). */
enum cli_exit cli_action_run(struct cli_daemon *daemon, const struct cli_action *action,
                             struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
