#include "enroll/cli/client/daemon_error.h"

#include <stddef.h>
#include <string.h>

#include "firmware/contract/contract.h"

/* If `text` is NULL, the text of the daemon itself is shown. */
static const struct translation {
    const char *name;
    enum cli_exit exit;
    const char *code, *text;
} translations[] = {
    {ISO_CONTRACT_ERROR_ALREADY_IN_USE, CLI_EXIT_FAULT, "already-in-use",
     "another program is using the camera; try again when it has finished"},
    {ISO_CONTRACT_ERROR_CLAIM_DEVICE, CLI_EXIT_FAULT, "claim-device", NULL},
    {ISO_CONTRACT_ERROR_NO_SUCH_PERSON, CLI_EXIT_NOT_FOUND, "no-such-person", NULL},
    {ISO_CONTRACT_ERROR_NO_ACTION, CLI_EXIT_FAULT, "no-action-in-progress", NULL},
    {ISO_CONTRACT_ERROR_ACTION, CLI_EXIT_FAULT, "action-in-progress", NULL},
    {ISO_CONTRACT_ERROR_INVALID_NAME, CLI_EXIT_USAGE, "invalid-name", NULL},
    {ISO_CONTRACT_ERROR_INVALID_ARGUMENT, CLI_EXIT_USAGE, "invalid-argument", NULL},
    {ISO_CONTRACT_ERROR_NAME_IN_USE, CLI_EXIT_NO, "name-in-use", NULL},
    {ISO_CONTRACT_ERROR_CONFLICT, CLI_EXIT_NO, "conflict",
     "the policy has been changed meanwhile; look at it (isotherm policy show) and try again"},
    {ISO_CONTRACT_ERROR_GALLERY_FULL, CLI_EXIT_FAULT, "gallery-full", NULL},
    {ISO_CONTRACT_ERROR_REJECTED, CLI_EXIT_FAULT, "rejected", NULL},
    {ISO_CONTRACT_ERROR_LOCKED_OUT, CLI_EXIT_NO, "locked-out", NULL},
    {ISO_CONTRACT_ERROR_TOO_MANY_CALLS, CLI_EXIT_FAULT, "too-many-calls", NULL},
    {ISO_CONTRACT_ERROR_DEVICE_FAULT, CLI_EXIT_FAULT, "device-fault", NULL},
    {ISO_CONTRACT_ERROR_STORAGE, CLI_EXIT_FAULT, "storage", NULL},
    {ISO_CONTRACT_ERROR_INTERNAL, CLI_EXIT_FAULT, "internal", NULL},
    {SD_BUS_ERROR_ACCESS_DENIED, CLI_EXIT_NO, "access-denied",
     "not permitted: only root and members of the right group may do this (see isothermd(8))"},
    {SD_BUS_ERROR_SERVICE_UNKNOWN, CLI_EXIT_FAULT, "no-daemon",
     "isothermd is not running on this bus (start it: systemctl start isothermd)"},
    {SD_BUS_ERROR_NAME_HAS_NO_OWNER, CLI_EXIT_FAULT, "no-daemon",
     "isothermd is not running on this bus (start it: systemctl start isothermd)"},
    {SD_BUS_ERROR_NO_REPLY, CLI_EXIT_TIMED_OUT, "no-reply", "the daemon does not answer"},
    {SD_BUS_ERROR_TIMEOUT, CLI_EXIT_TIMED_OUT, "no-reply", "the daemon does not answer"},
    {SD_BUS_ERROR_DISCONNECTED, CLI_EXIT_FAULT, "daemon-gone", "the bus has gone away"},
};

enum cli_exit cli_daemon_error(const sd_bus_error *error, int result, const char *method,
                               struct cli_fault *fault)
{
    const char *said = error->message ? error->message : strerror(-result);

    for (size_t i = 0; i < sizeof translations / sizeof *translations; i++) {
        const struct translation *known = &translations[i];
        if (sd_bus_error_has_name(error, known->name)) {
            return cli_fault_set(fault, known->exit, known->code, "%s",
                                 known->text ? known->text : said);
        }
    }
    return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "%s: %s", method, said);
}
