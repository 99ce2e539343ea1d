#include "enroll/cli/client/action.h"

#include <string.h>

#include "firmware/contract/contract.h"

static enum cli_exit start(struct cli_daemon *daemon, const struct cli_action *action,
                           struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, action->start, &call, fault);

    if (exit) {
        return exit;
    }
    const int r = action->append ? action->append(call, action->context) : 0;
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-argument", "%s: %s", action->start,
                             strerror(-r));
    }
    exit = cli_daemon_send(daemon, call, &reply, fault);
    if (!exit && action->answered) {
        action->answered(reply, action->context);
    }
    sd_bus_message_unref(reply);
    return exit;
}

/* Ignores faults: a fault of stopping or releasing would only hide the result of the action. */
static void finish(struct cli_daemon *daemon, const char *method)
{
    struct cli_fault ignored;

    (void)!cli_daemon_call(daemon, method, NULL, &ignored);
}

/* Listening begins after the claim, because earlier signals belong to another client. */
static enum cli_exit run_claimed(struct cli_daemon *daemon, const struct cli_action *action,
                                 struct cli_fault *fault)
{
    enum cli_exit exit;

    exit = cli_daemon_subscribe(daemon, action->signal, action->status, action->context, fault);
    if (!exit) {
        exit = start(daemon, action, fault);
    }
    if (exit) {
        return exit;
    }
    action->started(action->context);
    exit = cli_daemon_wait(daemon, action->timeout_s, fault);
    finish(daemon, action->stop);
    return exit;
}

enum cli_exit cli_action_run(struct cli_daemon *daemon, const struct cli_action *action,
                             struct cli_fault *fault)
{
    enum cli_exit exit;

    exit = cli_daemon_catch_interrupt(daemon, fault);
    if (!exit) {
        exit = cli_daemon_call(daemon, ISO_CONTRACT_CLAIM, NULL, fault);
    }
    if (exit) {
        return exit;
    }
    exit = run_claimed(daemon, action, fault);
    finish(daemon, ISO_CONTRACT_RELEASE);
    return exit;
}
