#include "enroll/cli/machine/places.h"

const struct cli_web_places cli_web_installed = {
    .program = ISOTHERM_WEB,
    .systemctl = "/usr/bin/systemctl",
    .root = true,
};

const struct cli_setup_places cli_setup_installed = {
    .config = ISOTHERM_CONFIG,
    .boards = ISOTHERM_SHARE "/boards",
    .cameras = ISOTHERM_SHARE "/cameras",
    .daemon = ISOTHERM_DAEMON,
    .sys = "/sys",
    .dev = "/dev",
    .unit = "isothermd.service",
    .root = true,
    .daemon_wait_s = 10,
};
