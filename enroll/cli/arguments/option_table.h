/* The options of all commands: which command takes which, and their help. */
#ifndef CLI_ARGUMENTS_OPTION_TABLE_H
#define CLI_ARGUMENTS_OPTION_TABLE_H

#include "enroll/cli/arguments/arguments.h"

/* In the order of the help. */
enum cli_option_id {
    CLI_OPTION_TIMEOUT,
    CLI_OPTION_QUICK,
    CLI_OPTION_ALLOW_DUPLICATE,
    CLI_OPTION_VALID_FROM,
    CLI_OPTION_VALID_UNTIL,
    CLI_OPTION_FROM,
    CLI_OPTION_UNTIL,
    CLI_OPTION_NONE,
    CLI_OPTION_EXPIRED,
    CLI_OPTION_COUNT,
    CLI_OPTION_FOLLOW,
    CLI_OPTION_HEAD,
    CLI_OPTION_ADDRESS,
    CLI_OPTION_PASSPHRASE_FILE,
    CLI_OPTION_PERSON,
    CLI_OPTION_DAY,
    CLI_OPTION_EVENT,
    CLI_OPTION_CSV,
    CLI_OPTION_FULL,
    CLI_OPTION_RESET,
    CLI_OPTION_REPLACE,
    CLI_OPTION_COMMISSION,
    CLI_OPTION_ANSWERS,
    CLI_OPTION_PICTURE,
    CLI_OPTION_SENSOR,
    CLI_OPTION_BOARD,
    CLI_OPTION_YES,
    CLI_OPTION_DRY_RUN,
    CLI_OPTION_AT,
    CLI_OPTION_DOOR,
    CLI_OPTION_SHOWN,
    CLI_OPTION_ZONE,
    CLI_OPTION_CARD,
    CLI_OPTION_NO_CARDS,
    CLI_OPTION_PIN,
    CLI_OPTION_NO_PIN,
    CLI_OPTION_DURESS_PIN,
    CLI_OPTION_NO_DURESS_PIN,
    CLI_OPTION_PROFILE,
    CLI_OPTION_NO_PROFILES,
    CLI_OPTION_ENABLE,
    CLI_OPTION_DISABLE,
    CLI_OPTION_ESCORT,
    CLI_OPTION_ANTIPASSBACK,
    CLI_OPTION_CLASS,
    CLI_OPTION_STATUS,
    CLI_OPTION_ALL,
    CLI_OPTION_JSON,
    CLI_OPTION_BUS,
    CLI_OPTION_SESSION,
    CLI_OPTION_HELP,
    CLI_OPTION_VERSION,
    CLI_OPTIONS
};

/* The bit of a command in cli_option.verbs. */
#define CLI_FOR(verb) (1u << (verb))

/* What an option does for one command. */
struct cli_option_help {
    enum cli_verb verb;
    const char *text;
};

struct cli_option {
    const char *name;                    /* without the two hyphens */
    const char *argument;                /* what the help calls its value; NULL: it takes none */
    unsigned verbs;                      /* the commands that take it, by CLI_FOR; 0: all */
    const char *help;                    /* NULL: it differs between commands, see parts */
    const struct cli_option_help *parts; /* one for each command; ended by a NULL text */
};

extern const struct cli_option cli_options[CLI_OPTIONS];

#endif
