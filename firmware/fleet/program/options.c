#include "firmware/fleet/program/options.h"

#include <errno.h>
#include <getopt.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define UPDATES_FOLDER "/var/lib/isotherm-update"

static const char usage[] =
    "Usage: isotherm-link [OPTION...] run           connects the door to its hub; for the service\n"
    "       isotherm-link [OPTION...] join ADDRESS  lets the door join a fleet\n"
    "       isotherm-link [OPTION...] leave         lets the door leave it\n"
    "       isotherm-link [OPTION...] status        says how the door stands in it\n"
    "\n"
    "  --state DIR    key, certificate and the hub's address (" ISOTHERM_LINK_STATE ")\n"
    "  --bus ADDRESS  system, session or an address of D-Bus (system)\n"
    "  --updates DIR  run, leave: updates of the image (" UPDATES_FOLDER ")\n"
    "  --restart FROM-UNTIL  run: hours of the day at which an update may restart the machine\n"
    "                 (any), such as 1-5; UTC on an image\n"
    "  --metrics      status: figures in the text format of Prometheus\n"
    "  --help         print this and end\n"
    "  --version      print the version and end\n";

enum choice { STATE = 1, BUS, METRICS, RESTART, UPDATES, HELP, VERSION };

static const struct option longs[] = {
    {"state", required_argument, NULL, STATE},     {"bus", required_argument, NULL, BUS},
    {"metrics", no_argument, NULL, METRICS},       {"help", no_argument, NULL, HELP},
    {"version", no_argument, NULL, VERSION},       {"restart", required_argument, NULL, RESTART},
    {"updates", required_argument, NULL, UPDATES}, {NULL, 0, NULL, 0},
};

static int complain(const char *why)
{
    fprintf(stderr, "isotherm-link: %s; try --help\n", why);
    return -EINVAL;
}

static int take(int option, const char *value, struct link_options *out)
{
    switch (option) {
    case STATE:
        out->state = value;
        return 0;
    case BUS:
        out->bus = value;
        return 0;
    case METRICS:
        out->metrics = true;
        return 0;
    case UPDATES:
        out->updates = value;
        return 0;
    case RESTART:
        return iso_restart_hours_read(value, &out->restart) == 0
                   ? 0
                   : complain("--restart needs two hours of the day, such as 1-5");
    case HELP:
        fputs(usage, stdout);
        return 1;
    case VERSION:
        puts("isotherm-link " ISOTHERM_VERSION);
        return 1;
    default:
        return -EINVAL; /* getopt has printed why */
    }
}

static int take_command(int n, char **words, struct link_options *out)
{
    static const char *const names[] = {"run", "join", "leave", "status"};
    unsigned i = 0;

    if (n == 0) {
        return complain("there is no command");
    }
    while (i < sizeof names / sizeof *names && strcmp(words[0], names[i]) != 0) {
        i++;
    }
    if (i == sizeof names / sizeof *names) {
        return complain("there is no such command");
    }
    out->command = (enum link_command)i;
    const int expected = out->command == LINK_COMMAND_JOIN ? 2 : 1;
    if (n != expected) {
        return complain(expected == 2 ? "join needs one address" : "there is a word too many");
    }
    if (out->metrics && out->command != LINK_COMMAND_STATUS) {
        return complain("--metrics is for status");
    }
    out->address = n == 2 ? words[1] : NULL;
    return 0;
}

int link_options_read(int argc, char **argv, struct link_options *out)
{
    int option, result = 0;

    *out = (struct link_options){.command = LINK_COMMAND_RUN,
                                 .bus = "system",
                                 .state = ISOTHERM_LINK_STATE,
                                 .updates = UPDATES_FOLDER};
    while (result == 0 && (option = getopt_long(argc, argv, "", longs, NULL)) != -1) {
        result = take(option, optarg, out);
    }
    return result == 0 ? take_command(argc - optind, argv + optind, out) : result;
}
