/* Chooses the board and the sensor: by the command line, by what was found, or by questions. */
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

/* Without a terminal, or with wish->yes, it asks nothing: it takes the only board that was
 * recognised and the only sensor that was found. If there is none, or more than one, CLI_EXIT_USAGE
 * names the missing option. Other faults as in cli_setup_run(). */
enum cli_exit cli_setup_choose(const struct cli_setup_places *places,
                               const struct cli_setup_wish *wish,
                               const struct cli_dialogue *dialogue, struct cli_setup_choice *out,
                               struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
