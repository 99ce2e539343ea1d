#include "enroll/cli/doctor/examine.h"

#include "enroll/cli/client/state.h"
#include "enroll/cli/doctor/configured.h"
#include "firmware/contract/contract.h"

static const char permission_remedy[] =
    "become a member of the group isotherm: adduser USER isotherm; then log in anew";

/* Whether the bus lets this user command the daemon. Release() without a claim changes nothing: the
 * daemon refuses it, and that it was asked at all is the answer. */
static void check_permission(struct cli_door *door, struct cli_diagnosis *diagnosis)
{
    struct cli_fault fault = {0};
    const enum cli_exit exit = cli_door_call(door, ISO_CONTRACT_RELEASE, NULL, &fault);

    if (exit == CLI_EXIT_NO) {
        cli_diagnosis_add(diagnosis, "permission", CLI_CHECK_DENIED,
                          "this user may not command the daemon", permission_remedy);
    } else {
        cli_diagnosis_add(diagnosis, "permission", CLI_CHECK_GOOD, "this user may", NULL);
    }
}

/* False if it makes no sense to go on: there is nobody to ask. */
static bool check_daemon(const struct cli_bus *bus, struct cli_door *door,
                         struct cli_diagnosis *diagnosis, json_t **state)
{
    struct cli_fault fault = {0};
    bool running = false;

    if (cli_door_has_daemon(door, &running, &fault) || !running) {
        cli_diagnosis_add(diagnosis, "daemon", CLI_CHECK_BAD, "isothermd is not on the bus",
                          cli_is_configured(bus)
                              ? "systemctl start isothermd; if it does not stay up: "
                                "journalctl --unit=isothermd"
                              : "isothermd is not configured yet: run isotherm setup");
        return false;
    }
    cli_diagnosis_add(diagnosis, "daemon", CLI_CHECK_GOOD, "running", NULL);
    const enum cli_exit exit = cli_state_fetch(door, state, &fault);
    if (exit == CLI_EXIT_NO) {
        cli_diagnosis_add(diagnosis, "permission", CLI_CHECK_DENIED, fault.text, permission_remedy);
    } else if (exit) {
        cli_diagnosis_add(diagnosis, "status", CLI_CHECK_BAD, fault.text,
                          "journalctl --unit=isothermd; systemctl restart isothermd");
    }
    return exit == CLI_EXIT_OK;
}

void cli_doctor_examine(const struct cli_bus *bus, struct cli_diagnosis *diagnosis)
{
    struct cli_fault fault = {0};
    struct cli_door *door = NULL;
    json_t *state = NULL;

    if (cli_door_open(bus, &door, &fault)) {
        cli_diagnosis_add(diagnosis, "bus", CLI_CHECK_BAD, fault.text,
                          "start the bus (systemctl start dbus), or name another with --bus");
        return;
    }
    cli_diagnosis_add(diagnosis, "bus", CLI_CHECK_GOOD, "reachable", NULL);
    if (check_daemon(bus, door, diagnosis, &state)) {
        cli_diagnosis_judge(diagnosis, state);
        check_permission(door, diagnosis);
    }
    json_decref(state);
    cli_door_close(door);
}
