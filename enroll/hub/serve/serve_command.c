#include "enroll/hub/serve/serve_command.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/broker/broker_config.h"
#include "enroll/hub/broker/hub_options.h"
#include "enroll/hub/serve/hub_serve.h"

enum { EXIT_USAGE = 2, EXIT_FAULT = 4, DAYS_MOST = 36500 };

static const char usage[] =
    "Usage: isotherm-hub serve [OPTION...]\n"
    "\n"
    "  --listen ADDRESS:PORT     of HTTPS, unless systemd passes a socket ([::]:8443)\n"
    "  --host NAME               by which doors reach HTTPS, once for each name or address (this "
    "machine's name)\n"
    "  --door-port PORT          by which doors reach HTTPS (that of --listen)\n"
    "  --pages DIR               the pages for administrators (none)\n"
    "  --broker HOST[:PORT]      where the hub reaches the broker (localhost:8884)\n"
    "  --door-broker HOST[:PORT] where the doors reach it (the first --host, port 8883)\n"
    "  --broker-folder DIR       its acl and crl.pem follow the doors\n"
    "  --metrics FILE            for the textfile collector of node_exporter\n"
    "  --keep-deltas DAYS        then changes go that not every door has confirmed (30; 0: never)\n"
    "  --keep-events DAYS        then the records of doors go (365; 0: never)\n"
    "  --keep-acts DAYS          then the acts of administrators go (730; 0: never)\n"
    "  --home-assistant          announce the doors to Home Assistant\n"
    "  --broker-plain            no TLS to the broker, for tests alone\n"
    "  --help                    print this and end\n";

enum choice {
    LISTEN = 1,
    HOST,
    PORT,
    PAGES,
    BROKER,
    DOOR_BROKER,
    FOLDER,
    METRICS,
    KEEP_DELTAS,
    KEEP_EVENTS,
    KEEP_ACTS,
    HOME,
    PLAIN,
    HELP
};

static const struct option longs[] = {
    {"listen", required_argument, NULL, LISTEN},
    {"host", required_argument, NULL, HOST},
    {"door-port", required_argument, NULL, PORT},
    {"pages", required_argument, NULL, PAGES},
    {"broker", required_argument, NULL, BROKER},
    {"door-broker", required_argument, NULL, DOOR_BROKER},
    {"broker-folder", required_argument, NULL, FOLDER},
    {"metrics", required_argument, NULL, METRICS},
    {"keep-deltas", required_argument, NULL, KEEP_DELTAS},
    {"keep-events", required_argument, NULL, KEEP_EVENTS},
    {"keep-acts", required_argument, NULL, KEEP_ACTS},
    {"home-assistant", no_argument, NULL, HOME},
    {"broker-plain", no_argument, NULL, PLAIN},
    {"help", no_argument, NULL, HELP},
    {NULL, 0, NULL, 0},
};

struct words {
    struct hub_serve_options options;
    struct hub_hosts hosts;
    char broker[HOST_NAME_MAX + 1], door_broker[HOST_NAME_MAX + 1];
};

/* Splits "HOST:PORT", "[ADDRESS]:PORT" or "HOST"; a bare IPv6 address has no port. */
static int split(const char *text, char host[HOST_NAME_MAX + 1], uint16_t *port)
{
    const char *colon = strrchr(text, ':');
    const char *end = text + strlen(text);

    if (*text == '[') {
        const char *bracket = strchr(++text, ']');
        if (!bracket) {
            return -EINVAL;
        }
        colon = bracket[1] == ':' ? bracket + 1 : NULL;
        end = bracket;
    } else if (colon && strchr(text, ':') == colon) {
        end = colon;
    } else {
        colon = NULL;
    }
    if (colon && hub_port_read(colon + 1, 1, port)) {
        return -EINVAL;
    }
    if (end == text || end - text > HOST_NAME_MAX) {
        return -EINVAL;
    }
    memcpy(host, text, (size_t)(end - text));
    host[end - text] = '\0';
    return 0;
}

static int read_days(const char *text, uint32_t *out)
{
    char *end = NULL;
    const unsigned long days = strtoul(text, &end, 10);

    if (*text < '0' || *text > '9' || *end || days > DAYS_MOST) {
        return -EINVAL;
    }
    *out = (uint32_t)days;
    return 0;
}

static int take(int option, const char *value, void *context)
{
    struct words *words = context;
    struct hub_serve_options *options = &words->options;

    switch (option) {
    case LISTEN:
        options->listen = value;
        return 0;
    case HOST:
        return hub_hosts_add(&words->hosts, value);
    case PORT:
        return hub_port_read(value, 1, &options->door_port);
    case PAGES:
        options->pages = value;
        return 0;
    case BROKER:
        options->broker_host = words->broker;
        return split(value, words->broker, &options->broker_port);
    case DOOR_BROKER:
        options->door_broker_host = words->door_broker;
        return split(value, words->door_broker, &options->door_broker_port);
    case FOLDER:
        options->broker_folder = value;
        return 0;
    case METRICS:
        options->metrics_file = value;
        return 0;
    case KEEP_DELTAS:
        return read_days(value, &options->keep.deltas);
    case KEEP_EVENTS:
        return read_days(value, &options->keep.events);
    case KEEP_ACTS:
        return read_days(value, &options->keep.acts);
    case HOME:
        options->home_assistant = true;
        return 0;
    case PLAIN:
        options->broker_plain = true;
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
    struct hub_serve_options *options = &words->options;
    int r = hub_options_read(argc, argv, longs, take, words);

    hub_hosts_complete(&words->hosts);
    options->n_hosts = words->hosts.n;
    memcpy(options->hosts, words->hosts.names, sizeof options->hosts);
    if (r == 0 && options->door_port == 0) {
        const char *colon = strrchr(options->listen, ':');
        r = colon ? hub_port_read(colon + 1, 1, &options->door_port) : 0;
    }
    if (r == 0 && !options->door_broker_host) {
        options->door_broker_host = options->hosts[0];
    }
    return r;
}

int hub_serve_command(const struct hub_store_options *store, const char *folder, int argc,
                      char **argv)
{
    static struct words words;
    struct iso_fault fault = {.text = ""};

    words = (struct words){.options = {.store = *store,
                                       .folder = folder,
                                       .listen = "[::]:8443",
                                       .broker_host = "localhost",
                                       .keep = {.deltas = 30, .events = 365, .acts = 730},
                                       .broker_port = HUB_BROKER_HUB_PORT,
                                       .door_broker_port = HUB_BROKER_PORT}};
    const int r = read_options(&words, argc, argv);
    if (r) {
        return r < 0 ? EXIT_USAGE : EXIT_SUCCESS;
    }
    if (hub_serve_run(&words.options, &fault)) {
        fprintf(stderr, "isotherm-hub: %s\n", fault.text);
        return EXIT_FAULT;
    }
    return EXIT_SUCCESS;
}
