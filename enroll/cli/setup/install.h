/* Installs a configuration: the daemon's program checks it, it is put in place, and the service is
 * started until the daemon is on the bus. If a step fails, everything is restored. */
#ifndef CLI_SETUP_INSTALL_H
#define CLI_SETUP_INSTALL_H

#include <limits.h>

#include "enroll/cli/setup/setup.h"

/* Checks the text with isothermd. For this it is written to a file in the folder of `beside`. If
 * the text is wrong, the fault names places->config and has the exit code of isothermd. */
enum cli_exit cli_setup_check(const struct cli_setup_places *places, const char *beside,
                              const char *text, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Checks and replaces the file, and starts the service. If `text` is NULL, the file stays as it is,
 * and only the service is restarted. `backup` receives the name of the old file, or "" if there is
 * none. After a fault or an interrupt, file and service are restored, and the fault says so. */
enum cli_exit cli_setup_install(const struct cli_setup_places *places,
                                const struct cli_bus *daemon_bus, const char *text,
                                char backup[PATH_MAX], struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
