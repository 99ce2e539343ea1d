/* The inside of the connection to RAUC, which installer.c, installer_run.c and installer_slots.c
 * share. */
#ifndef CLI_IMAGE_INSTALLER_INNER_H
#define CLI_IMAGE_INSTALLER_INNER_H

#include <systemd/sd-bus.h>

#include "enroll/cli/image/installer.h"

struct cli_installer {
    sd_bus *bus;
    struct cli_installer_state state;
    char owner[32]; /* RAUC's own connection */
};

/* Makes a fault of an error of a call. `result` is the negative errno of sd-bus. */
enum cli_exit cli_installer_fault(const sd_bus_error *error, int result, struct cli_fault *fault);

/* Asks for the state. Faults of cli_installer_open. */
enum cli_exit cli_installer_ask_state(struct cli_installer *installer, struct cli_fault *fault);

#endif
