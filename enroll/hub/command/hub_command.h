/* The commands of isotherm-hub: their table, and what each gets. */
#ifndef ISO_ENROLL_HUB_COMMAND_HUB_COMMAND_H
#define ISO_ENROLL_HUB_COMMAND_HUB_COMMAND_H

#include "enroll/hub/command/hub_config.h"
#include "enroll/hub/people/hub_person.h"
#include "enroll/hub/store/hub_store.h"

/* As those of the program isotherm: isotherm(1). */
enum hub_exit {
    HUB_EXIT_OK = 0,
    HUB_EXIT_NO = 1, /* refused, or some doors have not confirmed */
    HUB_EXIT_USAGE = 2,
    HUB_EXIT_NOT_FOUND = 3,
    HUB_EXIT_FAULT = 4, /* database, files */
};

/* The options, as bits: which of them a command has. */
enum hub_option {
    HUB_OPTION_ZONE = 1 << 0,
    HUB_OPTION_LEASE = 1 << 1,
    HUB_OPTION_LOCAL = 1 << 2,
    HUB_OPTION_APPROVE = 1 << 3,
    HUB_OPTION_FROM = 1 << 4,
    HUB_OPTION_UNTIL = 1 << 5,
    HUB_OPTION_SEARCH = 1 << 6,
    HUB_OPTION_UNSEEN = 1 << 7,
    HUB_OPTION_ALL = 1 << 8,
    HUB_OPTION_DOOR = 1 << 9,
    HUB_OPTION_PERSON = 1 << 10,
    HUB_OPTION_EVENT = 1 << 11,
    HUB_OPTION_SINCE = 1 << 12,
    HUB_OPTION_COUNT = 1 << 13,
    HUB_OPTION_WAIT = 1 << 14,
    HUB_OPTION_SECRET_FILE = 1 << 15,
    HUB_OPTION_CA = 1 << 16,
    HUB_OPTION_BEGINNING = 1 << 17,
    HUB_OPTION_URI = 1 << 18,
    HUB_OPTION_BASE = 1 << 19,
    HUB_OPTION_FILTER = 1 << 20,
    HUB_OPTION_MAP = 1 << 21,
    HUB_OPTION_BIND = 1 << 22,
    HUB_OPTION_DRY_RUN = 1 << 23,
    HUB_OPTION_FORCE = 1 << 24,
    HUB_OPTION_FIRST = 1 << 25,
    HUB_OPTION_STOP_AFTER = 1 << 26,
};

enum { HUB_WORDS_MAX = 4 };

struct hub_arguments {
    const char *config; /* NULL: HUB_CONFIG_PATH, which may be missing */
    unsigned given;     /* bits of enum hub_option */
    size_t n_words, n_zones;
    const char *words[HUB_WORDS_MAX]; /* behind the words of the command */
    const char *zones[HUB_PERSON_ZONES_MAX];
    bool local_people, approve_auto;
    uint32_t lease_s, count, wait_s, first, stop_after;
    int64_t from_s, until_s;
    const char *search, *door, *person, *event, *since;
    const char *secret_file, *ca, *uri, *base, *filter, *map, *bind;
};

/* What a command works with. */
struct hub_run {
    struct hub_config config;
    struct hub_arguments arguments;
    struct hub_store store; /* open, unless the command does without */
    struct iso_fault fault;
    const char *actor;
    bool unconfirmed; /* some doors have not confirmed: HUB_EXIT_NO */
};

struct hub_command {
    const char *words;    /* "zone add" */
    const char *synopsis; /* what follows them */
    const char *help;     /* one line, without a full stop */
    unsigned options;     /* which it has */
    uint8_t least, most;  /* words behind its own */
    bool without_store;
    int (*run)(struct hub_run *run); /* 0, or a negative errno with run->fault */
    /* In its place, for a command that reads its own options: argv[0] is its word. It opens the
     * store itself; *status is the exit code. */
    int (*run_whole)(struct hub_run *run, int argc, char **argv, int *status);
};

/* An entry of a table, for a command with an open store. */
#define HUB_COMMAND(WORDS, SYNOPSIS, HELP, OPTIONS, LEAST, MOST, RUN)                   \
    {                                                                                   \
        .words = (WORDS), .synopsis = (SYNOPSIS), .help = (HELP), .options = (OPTIONS), \
        .least = (LEAST), .most = (MOST), .run = (RUN)                                  \
    }

/* The tables of the files cmd_*.c; each ends with an entry without words. */
extern const struct hub_command hub_setup_commands[], hub_zone_commands[], hub_door_commands[],
    hub_person_commands[], hub_request_commands[], hub_event_commands[], hub_serve_commands[],
    hub_outlet_commands[], hub_directory_commands[], hub_scim_commands[], hub_metrics_commands[],
    hub_update_commands[];

/* Reads options and words behind those of the command. -EINVAL with a line. */
int hub_arguments_read(const struct hub_command *command, int argc, char **argv,
                       struct hub_arguments *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The whole program: finds the command, runs it, and prints a fault. Returns the exit code. */
int hub_command_main(int argc, char **argv);

/* ---- for several commands ---- */

enum { HUB_TIME_TEXT_SIZE = 32 };

/* "2026-11-21 08:30:15" in local time; "-" for 0. */
const char *hub_time_text(int64_t time_s, char text[HUB_TIME_TEXT_SIZE]);

/* The ids of the zones that --zone names. */
int hub_run_zones(struct hub_run *run, struct iso_fleet_id ids[HUB_PERSON_ZONES_MAX])
    __attribute__((warn_unused_result));

/* Waits until all doors of some zones have confirmed their places, at most --wait seconds (5 if it
 * is not given), and lists the others. */
int hub_run_confirm(struct hub_run *run, const struct iso_fleet_id *zones, size_t n)
    __attribute__((warn_unused_result));

/* Prints a join address, and its QR code on a terminal. */
int hub_print_address(struct hub_run *run, const char *code) __attribute__((warn_unused_result));

#endif
