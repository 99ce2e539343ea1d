#include "enroll/cli/doctor/configured.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/machine/places.h"

bool cli_is_configured(const struct cli_bus *bus)
{
    return bus->address || bus->session || access(cli_setup_installed.config, F_OK) == 0 ||
           errno != ENOENT;
}

void cli_explain_no_daemon(const struct cli_bus *bus, enum cli_exit exit, struct cli_fault *fault)
{
    if (strcmp(fault->code, "no-daemon") == 0 && !cli_is_configured(bus)) {
        (void)cli_fault_set(fault, exit, "no-daemon",
                            "isothermd is not configured yet: run isotherm setup");
    }
}
