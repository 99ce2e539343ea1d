/* The commands of the program. */
#ifndef CLI_ARGUMENTS_COMMAND_TABLE_H
#define CLI_ARGUMENTS_COMMAND_TABLE_H

#include "enroll/cli/arguments/arguments.h"

struct cli_command {
    const char *name;
    const char *words;   /* its operands: "NAME", "on|off", "[verify]"; "": it takes none */
    const char *summary; /* one line of the help, which begins with a small letter */
};

/* Indexed by enum cli_verb. */
extern const struct cli_command cli_commands[CLI_VERBS];

#endif
