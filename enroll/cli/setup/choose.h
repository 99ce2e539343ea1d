/* Which board and which sensor: from the command line, found, or asked. */
#ifndef CLI_SETUP_CHOOSE_H
#define CLI_SETUP_CHOOSE_H

#include "enroll/cli/machine/boards.h"
#include "enroll/cli/setup/sensor_word.h"
#include "enroll/cli/setup/setup.h"

struct cli_setup_choice {
    struct cli_board board;
    char *board_text; /* its isotherm.conf; the caller frees it */
    struct cli_sensor_word sensor;
};

/* Without a terminal, or with wish->yes, nothing is asked: the one board that was recognised and
 * the one sensor that was found are taken, and CLI_EXIT_USAGE names the option that is missing if
 * there is none, or more than one. Other faults as of cli_setup_run(). */
enum cli_exit cli_setup_choose(const struct cli_setup_places *places,
                               const struct cli_setup_wish *wish,
                               const struct cli_dialogue *dialogue, struct cli_setup_choice *out,
                               struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
