/* `isotherm setup` turns a machine with a camera into a running appliance. It finds boards and
 * depth cameras, asks for everything else, shows the configuration, checks it with the daemon's
 * program, puts it in place, starts the service, and shows a picture and the findings of `doctor`.
 * After a failure or an interrupt, the old file and the old state of the service are restored. */
#ifndef CLI_SETUP_SETUP_H
#define CLI_SETUP_SETUP_H

#include <stdbool.h>

#include "enroll/cli/client/daemon.h"
#include "enroll/cli/client/fault.h"
#include "enroll/cli/machine/places.h"
#include "enroll/cli/setup/dialogue.h"

/* The options of the command line; NULL: not given. */
struct cli_setup_wish {
    const char *sensor, *board; /* see sensor_word.h, boards.h */
    const char *picture;        /* where the picture goes */
    bool yes;                   /* ask nothing */
    bool dry_run;               /* show the file and change nothing */
    bool json;
    struct cli_bus bus; /* where the daemon will be */
};

/* Runs the setup. CLI_EXIT_OK: the file is in place and the daemon runs, whatever `doctor` finds.
 * Otherwise the fault says what failed, and the old state is restored. CLI_EXIT_NO if the person
 * answered no or is not root; CLI_EXIT_USAGE if an option is missing and cannot be asked for, or if
 * the daemon refuses the file; CLI_EXIT_NOT_FOUND if there is no such board; CLI_EXIT_INTERRUPTED;
 * CLI_EXIT_FAULT. */
enum cli_exit cli_setup_run(const struct cli_setup_places *places,
                            const struct cli_setup_wish *wish, const struct cli_dialogue *dialogue,
                            struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
