#include "enroll/cli/machine/places.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

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

const struct cli_image_places cli_image_installed = {
    .os_release = "/usr/lib/os-release", /* /etc/os-release is a link */
    .slot = "/run/isotherm/slot",
    .trial = "/run/isotherm/trial", /* of check-health (board/image/programs) */
    .packages = "/usr/lib/isotherm-image/packages",
    .dpkg_query = "/usr/bin/dpkg-query",
};

const struct cli_reset_places cli_reset_installed = {
    .daemon = ISOTHERM_DAEMON,
    .config = ISOTHERM_CONFIG,
    .systemctl = "/usr/bin/systemctl",
    .root = true,
};

void cli_places_policy_reader(char path[PATH_MAX])
{
    char own[PATH_MAX] = "";
    const ssize_t length = readlink("/proc/self/exe", own, sizeof own - 1);
    own[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(own, '/');
    const int folder = slash ? (int)(slash - own) : 0;
    (void)snprintf(path, PATH_MAX, "%.*s/../lib/isotherm/isotherm-policy-reader",
                   folder < PATH_MAX - 64 ? folder : 0, own);
}
