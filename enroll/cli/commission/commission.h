/* isotherm doctor --commission: walks the checklist of a door before it goes into service, and puts
 * the result on record. */
#ifndef CLI_COMMISSION_COMMISSION_H
#define CLI_COMMISSION_COMMISSION_H

#include <stdbool.h>

#include "enroll/cli/client/bus.h"
#include "enroll/cli/client/fault.h"
#include "enroll/cli/setup/dialogue.h"

struct cli_commission_wish {
    struct cli_bus bus;
    const char *answers; /* the file of answers; NULL: the person is asked */
    bool json;
};

/* Checks what the machine can check, takes the answers to everything else from the file or asks,
 * and records the result. CLI_EXIT_OK if the door has passed, CLI_EXIT_NO if warnings or skipped
 * items remain, CLI_EXIT_FAULT if something failed. CLI_EXIT_USAGE: nobody can be asked and there
 * is no file, or the file is wrong; CLI_EXIT_INTERRUPTED; and the faults of cli_daemon_send(). In
 * these cases nothing is recorded but a switch of the relay. */
enum cli_exit cli_commission(const struct cli_commission_wish *wish,
                             const struct cli_dialogue *dialogue, struct cli_fault *fault);

#endif
