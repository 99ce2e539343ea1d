/* The command line and its help, from the tables of commands and options (command_table.h,
 * option_table.h). */
#ifndef CLI_ARGUMENTS_ARGUMENTS_H
#define CLI_ARGUMENTS_ARGUMENTS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "enroll/cli/client/daemon.h"
#include "enroll/cli/client/fault.h"

enum cli_verb {
    CLI_ENROLL,
    CLI_IDENTIFY,
    CLI_VERIFY,
    CLI_LIST,
    CLI_REMOVE,
    CLI_VALIDITY,
    CLI_RENAME,
    CLI_STATUS,
    CLI_SITE,
    CLI_LOG,
    CLI_DOCTOR,
    CLI_AIM,
    CLI_EXPORT,
    CLI_IMPORT,
    CLI_KEY,
    CLI_LOCKDOWN,
    CLI_LOCKOUT,
    CLI_SETTINGS,
    CLI_SETUP,
    CLI_DOOR,
    CLI_PANEL,
    CLI_POLICY,
    CLI_CREDENTIAL,
    CLI_WEB,
    CLI_UPDATE,
    CLI_VERSION,
    CLI_FACTORY_RESET,
    CLI_VERBS /* how many there are; as a verb: no command was given */
};

enum { CLI_PEOPLE_MAX = 64, CLI_CARDS_MAX = 8, CLI_PROFILES_MAX = 8 };

/* What `credential set` changes. */
struct cli_credential_change {
    const char *cards[CLI_CARDS_MAX]; /* instead of all cards */
    size_t n_cards;
    const char *profiles[CLI_PROFILES_MAX]; /* instead of all profiles */
    size_t n_profiles;
    bool no_cards, no_profiles;
    bool pin, duress_pin, no_pin, no_duress_pin; /* pin, duress_pin: a new one is asked for */
    bool enable;
    const char *disable;               /* the reason; NULL: not given */
    const char *escort, *antipassback; /* "yes" or "no"; NULL: not given */
    bool has_class;                    /* the number below is given */
    unsigned two_person_class;
};

struct cli_arguments {
    enum cli_verb verb;
    const char *person; /* the same as word, for the commands that take a NAME */
    const char *word;   /* the word after the command, a NAME or another one; NULL: there is none */
    const char *name;   /* rename: the new name; settings: the value; policy: the file; credential:
                         * the person; NULL: not given */
    bool help, version, json;
    struct cli_bus bus;
    double timeout_s;                      /* 0: the default of the command */
    bool allow_duplicate;                  /* enroll */
    bool quick;                            /* enroll: the frontal face alone */
    bool names_from, names_until;          /* enroll, validity: which limits are given */
    int64_t valid_from_s, valid_until_s;   /* these limits, since 1970; 0: no limit */
    bool expired;                          /* enroll, validity: an end in the past is accepted */
    bool none;                             /* validity: remove both limits */
    const char *from_text;                 /* log, validity: --from as it was typed */
    uint64_t from;                         /* log: a sequence number; 0: not given */
    unsigned count;                        /* log: the most records; 0: not given */
    bool follow;                           /* log */
    int64_t day_begins_s, day_ends_s;      /* log: the day, without its end; 0: every day */
    const char *events;                    /* log: "visit,door"; NULL: all */
    bool csv, full;                        /* log */
    const char *head;                      /* log verify: of an earlier report; NULL: not given */
    const char *address, *passphrase_file; /* export, import; NULL: not given */
    const char *people[CLI_PEOPLE_MAX]; /* export, log: only these; none: all. policy test: one */
    size_t n_people;
    bool reset;                              /* settings: back to the configuration file */
    bool replace;                            /* import */
    bool commission;                         /* doctor: walk the checklist of a new door */
    const char *answers;                     /* doctor: the file of answers; NULL: ask */
    const char *picture;                     /* aim, setup: the file to write; NULL: not given */
    const char *sensor, *board;              /* setup; NULL: not given */
    bool yes;                                /* setup, door test, factory-reset: ask nothing */
    bool dry_run;                            /* setup, policy import */
    bool has_at;                             /* policy test: the moment below is given */
    int64_t at_s;                            /* since 1970 */
    const char *door, *zone;                 /* policy test, policy import; NULL: not given */
    const char *shown;                       /* policy test: "face,card"; NULL: not given */
    bool all;                                /* version: of everything */
    bool status;                             /* update: show what there is */
    struct cli_credential_change credential; /* credential set */
};

/* Reads argv: options and words in any order. The texts of *out point into argv. With --help or
 * --version nothing else is required. CLI_EXIT_USAGE if something is wrong: an unknown command or
 * option, an option of another command, or a missing, superfluous or bad value. out->json is
 * correct even then, so that the fault can be printed in the requested form. */
enum cli_exit cli_arguments_parse(int argc, char **argv, struct cli_arguments *out,
                                  struct cli_fault *fault) __attribute__((warn_unused_result));

/* Prints the help of a command, or for CLI_VERBS that of the program. */
void cli_arguments_help(enum cli_verb verb, FILE *out);

#endif
