#include "enroll/cli/image/installer.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/image/installer_inner.h"

/* RAUC has to be started first, and asks the boot loader for its entries. */
enum { CALL_TIMEOUT_US = 60 * 1000 * 1000 };

static const struct {
    const char *name;
    enum cli_exit exit;
    const char *code, *text;
} translations[] = {
    {SD_BUS_ERROR_SERVICE_UNKNOWN, CLI_EXIT_NOT_FOUND, "no-image",
     "there is no RAUC on this bus: only an image of the appliance is updated like this, other "
     "machines by their packages"},
    {SD_BUS_ERROR_ACCESS_DENIED, CLI_EXIT_NO, "access-denied",
     "not permitted: only root and members of the group isotherm may update the appliance"},
    {SD_BUS_ERROR_NO_REPLY, CLI_EXIT_TIMED_OUT, "no-reply", "RAUC does not answer"},
    {SD_BUS_ERROR_TIMEOUT, CLI_EXIT_TIMED_OUT, "no-reply", "RAUC does not answer"},
    {SD_BUS_ERROR_DISCONNECTED, CLI_EXIT_FAULT, "no-bus", "the bus has gone away"},
};

enum cli_exit cli_installer_fault(const sd_bus_error *error, int result, struct cli_fault *fault)
{
    for (size_t i = 0; i < sizeof translations / sizeof *translations; i++) {
        if (sd_bus_error_has_name(error, translations[i].name)) {
            return cli_fault_set(fault, translations[i].exit, translations[i].code, "%s",
                                 translations[i].text);
        }
    }
    return cli_fault_set(fault, CLI_EXIT_FAULT, "update-fault", "RAUC: %s",
                         error->message ? error->message : strerror(-result));
}

enum cli_exit cli_installer_ask_state(struct cli_installer *installer, struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    sd_bus_message *reply = NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    int r = sd_bus_call_method(installer->bus, CLI_RAUC, CLI_RAUC_PATH,
                               "org.freedesktop.DBus.Properties", "GetAll", &error, &reply, "s",
                               CLI_RAUC_INTERFACE);

    if (r >= 0) {
        (void)snprintf(installer->owner, sizeof installer->owner, "%s",
                       sd_bus_message_get_sender(reply));
        r = cli_rauc_read_state(reply, &installer->state);
    }
    if (r < 0) {
        exit = cli_installer_fault(&error, r, fault);
    }
    sd_bus_message_unref(reply);
    sd_bus_error_free(&error);
    return exit;
}

const struct cli_installer_state *cli_installer_state(const struct cli_installer *installer)
{
    return &installer->state;
}

bool cli_installer_is_busy(const struct cli_installer *installer)
{
    return cli_rauc_is_busy(&installer->state);
}

/* ---- connection ---- */

enum cli_exit cli_installer_open(const struct cli_bus *bus, struct cli_installer **out,
                                 struct cli_fault *fault)
{
    struct cli_installer *installer = calloc(1, sizeof *installer);
    int r = installer ? cli_bus_connect(bus, &installer->bus) : -ENOMEM;

    if (r >= 0) {
        r = sd_bus_set_method_call_timeout(installer->bus, CALL_TIMEOUT_US);
    }
    const enum cli_exit exit = r < 0 ? cli_fault_set(fault, CLI_EXIT_FAULT, "no-bus",
                                                     "cannot reach the bus: %s", strerror(-r))
                                     : cli_installer_ask_state(installer, fault);
    if (exit) {
        cli_installer_close(installer);
        return exit;
    }
    *out = installer;
    return CLI_EXIT_OK;
}

void cli_installer_close(struct cli_installer *installer)
{
    if (installer) {
        sd_bus_flush_close_unref(installer->bus);
        free(installer);
    }
}
