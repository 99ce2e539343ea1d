/* Asks at the terminal whether something shall really be done. */
#ifndef CLI_TEXT_CONFIRM_H
#define CLI_TEXT_CONFIRM_H

#include "enroll/cli/client/fault.h"

/* What is asked. */
struct cli_confirmation {
    const char *what;     /* "door test unlocks the door for half a second" */
    const char *question; /* lines that say what will happen, each with its end */
    const char *not_done; /* "the relay was not switched" */
};

/* Returns CLI_EXIT_OK if the answer is yes; CLI_EXIT_NO "not-confirmed" if it is not;
 * CLI_EXIT_USAGE, with a fault that names --yes, if standard input is no terminal. */
enum cli_exit cli_confirm(const struct cli_confirmation *confirmation, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
