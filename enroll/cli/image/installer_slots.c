/* Asks RAUC for the slots of the image. */
#include "enroll/cli/image/installer.h"

#include "enroll/cli/image/installer_inner.h"

/* If the boot loader can start nothing, RAUC answers with an error, and no slot is the next. */
static void mark_next(struct cli_installer *installer, struct cli_slots *slots)
{
    sd_bus_error ignored = SD_BUS_ERROR_NULL;
    sd_bus_message *reply = NULL;
    const int r = sd_bus_call_method(installer->bus, CLI_RAUC, CLI_RAUC_PATH, CLI_RAUC_INTERFACE,
                                     "GetPrimary", &ignored, &reply, "");

    if (r >= 0) {
        cli_rauc_read_primary(reply, slots);
    }
    sd_bus_message_unref(reply);
    sd_bus_error_free(&ignored);
}

enum cli_exit cli_installer_slots(struct cli_installer *installer, struct cli_slots *out,
                                  struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    sd_bus_message *reply = NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    int r = sd_bus_call_method(installer->bus, CLI_RAUC, CLI_RAUC_PATH, CLI_RAUC_INTERFACE,
                               "GetSlotStatus", &error, &reply, "");

    *out = (struct cli_slots){.n = 0};
    if (r >= 0) {
        r = cli_rauc_read_slots(reply, out);
    }
    if (r < 0) {
        exit = cli_installer_fault(&error, r, fault);
    } else {
        mark_next(installer, out);
    }
    sd_bus_message_unref(reply);
    sd_bus_error_free(&error);
    return exit;
}
