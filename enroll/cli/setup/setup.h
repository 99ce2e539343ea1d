/* `isotherm setup`: from a machine with a camera to a running appliance. It finds boards and depth
 * cameras, asks what it cannot know, shows the configuration it will write, has the daemon check
 * it, puts it in place, starts the service, and shows a picture and the findings of `doctor`. When
 * something fails, or somebody interrupts, the old file and the old state of the service are put
 * back. */
#ifndef CLI_SETUP_SETUP_H
#define CLI_SETUP_SETUP_H

#include <stdbool.h>

#include "enroll/cli/client/daemon.h"
#include "enroll/cli/client/fault.h"
#include "enroll/cli/machine/places.h"
#include "enroll/cli/setup/dialogue.h"

/* What the command line says; NULL: not given. */
struct cli_setup_wish {
    const char *sensor, *board; /* see sensor_word.h, boards.h */
    const char *picture;        /* where the picture goes */
    bool yes;                   /* ask nothing */
    bool dry_run;               /* show the file and change nothing */
    bool json;
    struct cli_bus bus; /* where the daemon will be */
};

/* CLI_EXIT_OK: the file is in place and the daemon runs, whatever `doctor` finds. Else the fault
 * says what failed, and nothing has changed. CLI_EXIT_NO somebody does not want it, or is not root;
 * CLI_EXIT_USAGE what is missing cannot be asked, or the daemon refuses the configuration;
 * CLI_EXIT_NOT_FOUND no such board; CLI_EXIT_INTERRUPTED; CLI_EXIT_FAULT. */
enum cli_exit cli_setup_run(const struct cli_setup_places *places,
                            const struct cli_setup_wish *wish, const struct cli_dialogue *dialogue,
                            struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
