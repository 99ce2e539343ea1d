/* Puts a configuration to use: checked by the daemon's program, in place, the service started, the
 * daemon on the bus; or everything as it was before. */
#ifndef CLI_SETUP_INSTALL_H
#define CLI_SETUP_INSTALL_H

#include <limits.h>

#include "enroll/cli/setup/setup.h"

/* Whether isothermd takes the text for sound, which is written into a file beside `beside` for
 * that. The fault of one that is not sound names places->config, and has the exit code of
 * isothermd. */
enum cli_exit cli_setup_check(const struct cli_setup_places *places, const char *beside,
                              const char *text, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Checks, replaces, starts. `text` NULL: the file is right, only the service is started again.
 * `backup` becomes the name of the old file, "" if there is none. On a fault, and on an interrupt,
 * file and service are as they were, and the fault says so. */
enum cli_exit cli_setup_install(const struct cli_setup_places *places,
                                const struct cli_bus *daemon_bus, const char *text,
                                char backup[PATH_MAX], struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
