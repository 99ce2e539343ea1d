#include "enroll/cli/doctor/examine.h"

#include "enroll/cli/client/state.h"
#include "enroll/cli/doctor/configured.h"
#include "firmware/contract/contract.h"

/* Finds out whether the bus lets this user command the daemon, by calling Release(). Without a
 * claim the daemon refuses this call, which then changes nothing. If the call reaches the daemon,
 * the user may command it. */
static void check_permission(struct cli_daemon *daemon, struct cli_diagnosis *diagnosis)
{
    struct cli_fault fault = {0};
    const enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_RELEASE, NULL, &fault);

    if (exit == CLI_EXIT_NO) {
        cli_diagnosis_add(diagnosis, "permission", CLI_CHECK_DENIED, ISO_FAULT_NOT_PERMITTED,
                          "this user may not give commands to the daemon");
    } else {
        cli_diagnosis_add(diagnosis, "permission", CLI_CHECK_GOOD, ISO_FAULT_NONE, "this user may");
    }
}

/* Returns false if further checks make no sense, because there is no daemon to ask. */
static bool check_daemon(const struct cli_bus *bus, struct cli_daemon *daemon,
                         struct cli_diagnosis *diagnosis, json_t **state)
{
    struct cli_fault fault = {0};
    bool running = false;

    if (cli_daemon_has_daemon(daemon, &running, &fault) || !running) {
        const bool configured = cli_is_configured(bus);
        cli_diagnosis_add(diagnosis, "daemon", CLI_CHECK_BAD,
                          configured ? ISO_FAULT_NO_DAEMON : ISO_FAULT_NOT_CONFIGURED,
                          configured ? "isothermd is not on the bus"
                                     : "isothermd is not configured yet: run isotherm setup");
        return false;
    }
    cli_diagnosis_add(diagnosis, "daemon", CLI_CHECK_GOOD, ISO_FAULT_NONE, "running");
    const enum cli_exit exit = cli_state_fetch(daemon, state, &fault);
    if (exit == CLI_EXIT_NO) {
        cli_diagnosis_add(diagnosis, "permission", CLI_CHECK_DENIED, ISO_FAULT_NOT_PERMITTED,
                          fault.text);
    } else if (exit) {
        cli_diagnosis_add(diagnosis, "status", CLI_CHECK_BAD, ISO_FAULT_NO_STATUS, fault.text);
    }
    return exit == CLI_EXIT_OK;
}

void cli_doctor_examine(const struct cli_bus *bus, struct cli_diagnosis *diagnosis)
{
    struct cli_fault fault = {0};
    struct cli_daemon *daemon = NULL;
    json_t *state = NULL;

    if (cli_daemon_open(bus, &daemon, &fault)) {
        cli_diagnosis_add(diagnosis, "bus", CLI_CHECK_BAD, ISO_FAULT_BUS_MISSING, fault.text);
        return;
    }
    cli_diagnosis_add(diagnosis, "bus", CLI_CHECK_GOOD, ISO_FAULT_NONE, "reachable");
    if (check_daemon(bus, daemon, diagnosis, &state)) {
        cli_diagnosis_judge(diagnosis, state);
        check_permission(daemon, diagnosis);
    }
    json_decref(state);
    cli_daemon_close(daemon);
}
