#include "enroll/hub/broker/broker_command.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "enroll/hub/broker/broker_config.h"
#include "enroll/hub/broker/hub_options.h"

enum { EXIT_USAGE = 2, EXIT_FAULT = 4 };

#define DEFAULT_FOLDER      "/var/lib/isotherm-broker"
#define DEFAULT_PERSISTENCE "/var/lib/mosquitto"

static const char usage[] =
    "Usage: isotherm-hub broker-config [OPTION...]\n"
    "Writes the configuration of mosquitto for this fleet.\n"
    "\n"
    "  --output DIR        (" DEFAULT_FOLDER ")\n"
    "  --host NAME         by which doors and hub reach the broker, once for each name or address\n"
    "                      (this machine's name; localhost, 127.0.0.1 and ::1 are added)\n"
    "  --port PORT         of the doors (8883)\n"
    "  --hub-port PORT     of the hub (8884); 0: the hub uses the doors' port\n"
    "  --hub-address ADDR  to which the hub's port is bound (127.0.0.1)\n"
    "  --persistence DIR   where mosquitto keeps what it retains (" DEFAULT_PERSISTENCE ")\n"
    "  --home-assistant    also write a certificate for Home Assistant\n"
    "  --help              print this and end\n";

enum choice { OUTPUT = 1, HOST, PORT, HUB_PORT, HUB_ADDRESS, PERSISTENCE, HOME, HELP };

static const struct option longs[] = {
    {"output", required_argument, NULL, OUTPUT},
    {"host", required_argument, NULL, HOST},
    {"port", required_argument, NULL, PORT},
    {"hub-port", required_argument, NULL, HUB_PORT},
    {"hub-address", required_argument, NULL, HUB_ADDRESS},
    {"persistence", required_argument, NULL, PERSISTENCE},
    {"home-assistant", no_argument, NULL, HOME},
    {"help", no_argument, NULL, HELP},
    {NULL, 0, NULL, 0},
};

struct words {
    struct broker_places places;
    struct hub_hosts hosts;
};

static int take(int option, const char *value, void *context)
{
    struct words *words = context;

    switch (option) {
    case OUTPUT:
        words->places.folder = value;
        return 0;
    case HOST:
        return hub_hosts_add(&words->hosts, value);
    case PORT:
        return hub_port_read(value, 1, &words->places.port);
    case HUB_PORT:
        return hub_port_read(value, 0, &words->places.hub_port);
    case HUB_ADDRESS:
        words->places.hub_address = value;
        return 0;
    case PERSISTENCE:
        words->places.persistence = value;
        return 0;
    case HOME:
        words->places.home_assistant = true;
        return 0;
    case HELP:
        fputs(usage, stdout);
        return 1;
    default:
        return -ENOTSUP; /* getopt has printed why */
    }
}

static int read_options(struct words *words, int argc, char **argv)
{
    static const char *const local[] = {"localhost", "127.0.0.1", "::1"};
    const int r = hub_options_read(argc, argv, longs, take, words);

    hub_hosts_complete(&words->hosts);
    /* As many of these as there is room for. */
    for (size_t i = 0; i < sizeof local / sizeof *local && words->hosts.n < HUB_PAIR_HOSTS_MOST;
         i++) {
        words->hosts.names[words->hosts.n++] = local[i];
    }
    return r;
}

static int run(const struct hub_store_options *options, const char *folder,
               const struct words *words, bool *changed, struct iso_fault *fault)
{
    struct hub_store store = {.db = NULL};
    struct hub_ca *ca = NULL;
    int r = iso_fleet_start(fault);

    r = r < 0 ? r : hub_store_open(options, &store, fault);
    r = r < 0 ? r : hub_ca_open(folder, &ca, fault);
    r = r < 0 ? r
              : broker_config_write(&store, ca, &words->places, words->hosts.names, words->hosts.n,
                                    changed, fault);
    hub_ca_free(ca);
    hub_store_close(&store);
    return r;
}

int hub_broker_command(const struct hub_store_options *store, const char *folder, int argc,
                       char **argv)
{
    static struct words words;
    struct iso_fault fault = {.text = ""};
    bool changed = false;

    words = (struct words){.places = {.folder = DEFAULT_FOLDER,
                                      .persistence = DEFAULT_PERSISTENCE,
                                      .hub_address = "127.0.0.1",
                                      .port = HUB_BROKER_PORT,
                                      .hub_port = HUB_BROKER_HUB_PORT}};
    const int r = read_options(&words, argc, argv);
    if (r) {
        return r < 0 ? EXIT_USAGE : EXIT_SUCCESS;
    }
    if (run(store, folder, &words, &changed, &fault)) {
        fprintf(stderr, "isotherm-hub: %s\n", fault.text);
        return EXIT_FAULT;
    }
    if (changed) {
        printf("%s is written. Start the broker with `mosquitto -c %s/mosquitto.conf`; if it runs, "
               "let it read the files anew: `systemctl reload mosquitto`, or SIGHUP.\n",
               words.places.folder, words.places.folder);
    } else {
        printf("%s is as it should be.\n", words.places.folder);
    }
    return EXIT_SUCCESS;
}
