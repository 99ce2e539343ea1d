#include "enroll/web/options.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#define DEFAULT_LISTEN "127.0.0.1:8443"

static const char usage[] =
    "Usage: isotherm-web [OPTION...]              serves the pages of the door, by HTTPS\n"
    "       isotherm-web [OPTION...] setup-code   prints a code for an administrator's account\n"
    "       isotherm-web [OPTION...] fingerprint  prints the SHA-256 of the certificate\n"
    "\n"
    "  --listen ADDRESS:PORT  unless systemd passes a socket (" DEFAULT_LISTEN ")\n"
    "  --state DIR            accounts, key and certificate (" ISOTHERM_WEB_STATE ")\n"
    "  --pages DIR            the pages (" ISOTHERM_WEB_PAGES ")\n"
    "  --updates DIR          updates of an image of the appliance (" ISOTHERM_WEB_UPDATES ")\n"
    "  --first-code           print a code while there is no account (for an image)\n"
    "  --bus ADDRESS          system, session or an address of D-Bus (system)\n"
    "  --help                 print this and end\n"
    "  --version              print the version and end\n";

enum choice { LISTEN = 1, STATE, PAGES, UPDATES, FIRST_CODE, BUS, HELP, VERSION };

static const struct option longs[] = {
    {"listen", required_argument, NULL, LISTEN},
    {"state", required_argument, NULL, STATE},
    {"pages", required_argument, NULL, PAGES},
    {"updates", required_argument, NULL, UPDATES},
    {"first-code", no_argument, NULL, FIRST_CODE},
    {"bus", required_argument, NULL, BUS},
    {"help", no_argument, NULL, HELP},
    {"version", no_argument, NULL, VERSION},
    {NULL, 0, NULL, 0},
};

static int take(int option, const char *value, struct web_options *out)
{
    switch (option) {
    case LISTEN:
        out->listen = value;
        return 0;
    case STATE:
        out->state = value;
        return 0;
    case PAGES:
        out->pages = value;
        return 0;
    case UPDATES:
        out->updates = value;
        return 0;
    case FIRST_CODE:
        out->first_code = true;
        return 0;
    case BUS:
        out->bus = value;
        return 0;
    case HELP:
        fputs(usage, stdout);
        return 1;
    case VERSION:
        puts("isotherm-web " ISOTHERM_VERSION);
        return 1;
    default:
        return -EINVAL; /* getopt has printed why */
    }
}

static int take_command(const char *word, struct web_options *out)
{
    if (strcmp(word, "setup-code") == 0) {
        out->command = WEB_COMMAND_SETUP_CODE;
    } else if (strcmp(word, "fingerprint") == 0) {
        out->command = WEB_COMMAND_FINGERPRINT;
    } else {
        fprintf(stderr, "isotherm-web: %s: there is no such command\n", word);
        return -EINVAL;
    }
    return 0;
}

int web_options_read(int argc, char **argv, struct web_options *out)
{
    int option, result = 0;

    *out = (struct web_options){.command = WEB_COMMAND_SERVE,
                                .bus = "system",
                                .listen = DEFAULT_LISTEN,
                                .state = ISOTHERM_WEB_STATE,
                                .pages = ISOTHERM_WEB_PAGES,
                                .updates = ISOTHERM_WEB_UPDATES};
    while (result == 0 && (option = getopt_long(argc, argv, "", longs, NULL)) != -1) {
        result = take(option, optarg, out);
    }
    if (result == 0 && optind < argc) {
        result = take_command(argv[optind++], out);
    }
    if (result == 0 && optind < argc) {
        fprintf(stderr, "isotherm-web: %s: there is one word at most\n", argv[optind]);
        result = -EINVAL;
    }
    return result;
}
