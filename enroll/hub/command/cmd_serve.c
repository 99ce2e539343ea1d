/* serve, setup-code, broker-config: the configuration becomes options of these commands, and
 * options of the command line follow them. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "enroll/hub/broker/broker_command.h"
#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/serve/serve_command.h"
#include "enroll/web/account/setup_code.h"

enum { OPTIONS_MAX = 96, PLACE_SIZE = HUB_CONFIG_TEXT_SIZE + 16 };

/* Options that are put together. */
struct options {
    char *words[OPTIONS_MAX];
    int n;
    char hosts[HUB_CONFIG_TEXT_SIZE], broker[PLACE_SIZE], door_broker[PLACE_SIZE], ports[2][8],
        door_port[8], days[3][16];
};

static void add(struct options *options, const char *word)
{
    if (options->n < OPTIONS_MAX - 1) {
        options->words[options->n++] = (char *)(uintptr_t)word;
    }
}

static void add_pair(struct options *options, const char *name, const char *value)
{
    if (*value) {
        add(options, name);
        add(options, value);
    }
}

/* --host for one name, and for those between blanks in [hub] hosts. */
static void add_hosts(struct options *options, const char *first, const char *others)
{
    char *rest = NULL;
    add_pair(options, "--host", first);
    (void)snprintf(options->hosts, sizeof options->hosts, "%s", others);
    for (char *word = strtok_r(options->hosts, " \t", &rest); word;
         word = strtok_r(NULL, " \t", &rest)) {
        add_pair(options, "--host", word);
    }
}

/* "HOST:PORT", or "[ADDRESS]:PORT" for IPv6. */
static const char *place(char out[PLACE_SIZE], const char *host, int port)
{
    (void)snprintf(out, PLACE_SIZE, strchr(host, ':') ? "[%s]:%d" : "%s:%d", host, port);
    return out;
}

/* The words of the command line. Fails if there are too many. */
static int add_rest(struct options *options, struct hub_run *run, int argc, char **argv)
{
    if (options->n + argc >= OPTIONS_MAX) {
        return iso_fault_set(&run->fault, -EINVAL, "%s: too many options", argv[0]);
    }
    for (int i = 1; i < argc; i++) {
        add(options, argv[i]);
    }
    options->words[options->n] = NULL;
    return 0;
}

static struct hub_store_options store_of(const struct hub_run *run, const char *actor)
{
    return (struct hub_store_options){.conninfo = run->config.conninfo,
                                      .key_file = run->config.key_file,
                                      .hub_name = run->config.name,
                                      .actor = actor};
}

/* The rights of the doors in the broker's folder follow the doors, if the broker is here. */
static bool is_folder(const char *path)
{
    struct stat s;
    return *path && stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

static int serve(struct hub_run *run, int argc, char **argv, int *status)
{
    const struct hub_config *c = &run->config;
    const struct hub_store_options store = store_of(run, "hub");
    struct options options = {.n = 0};
    add(&options, argv[0]);
    add_pair(&options, "--listen", c->listen);
    add_hosts(&options, c->host, c->hosts);
    (void)snprintf(options.door_port, sizeof options.door_port, "%d", c->port);
    add_pair(&options, "--door-port", options.door_port);
    add_pair(&options, "--pages", c->pages);
    add_pair(&options, "--broker", place(options.broker, c->broker_hub_host, c->broker_hub_port));
    add_pair(&options, "--door-broker", place(options.door_broker, c->broker_host, c->broker_port));
    add_pair(&options, "--broker-folder", is_folder(c->broker_folder) ? c->broker_folder : "");
    add_pair(&options, "--metrics", c->metrics);
    const int days[3] = {c->keep_deltas, c->keep_events, c->keep_acts};
    static const char *const keep[3] = {"--keep-deltas", "--keep-events", "--keep-acts"};
    for (size_t i = 0; i < 3; i++) {
        (void)snprintf(options.days[i], sizeof options.days[i], "%d", days[i]);
        add_pair(&options, keep[i], options.days[i]);
    }
    if (c->home_assistant) {
        add(&options, "--home-assistant");
    }
    const int error = add_rest(&options, run, argc, argv);
    if (!error) {
        *status = hub_serve_command(&store, c->folder, options.n, options.words);
    }
    return error;
}

static int configure_broker(struct hub_run *run, int argc, char **argv, int *status)
{
    const struct hub_config *c = &run->config;
    const struct hub_store_options store = store_of(run, run->actor);
    struct options options = {.n = 0};
    const int ports[2] = {c->broker_port, c->broker_hub_port};
    for (size_t i = 0; i < 2; i++) {
        (void)snprintf(options.ports[i], sizeof options.ports[i], "%d", ports[i]);
    }
    add(&options, argv[0]);
    add_pair(&options, "--output", c->broker_folder);
    add_hosts(&options, c->broker_host, c->hosts);
    add_pair(&options, "--host", c->broker_hub_host);
    add_pair(&options, "--port", options.ports[0]);
    add_pair(&options, "--hub-port", options.ports[1]);
    add_pair(&options, "--persistence", c->broker_persistence);
    if (c->home_assistant) {
        add(&options, "--home-assistant");
    }
    const int error = add_rest(&options, run, argc, argv);
    if (!error) {
        *status = hub_broker_command(&store, c->folder, options.n, options.words);
    }
    return error;
}

static int make_code(struct hub_run *run)
{
    char path[PLACE_SIZE], code[WEB_SETUP_CODE_SIZE];
    (void)snprintf(path, sizeof path, "%s/setup.code", run->config.folder);
    const int error = web_setup_code_make(path, time(NULL), code, &run->fault);
    if (!error) {
        puts(code);
        fprintf(stderr,
                "isotherm-hub: the code makes one account of an administrator, within a day\n");
        sodium_memzero(code, sizeof code);
    }
    return error;
}

const struct hub_command hub_serve_commands[] = {
    {.words = "serve",
     .synopsis = "[OPTION...]",
     .help = "serve the doors until the service manager ends it; serve --help lists its options",
     .run_whole = serve},
    {.words = "broker-config",
     .synopsis = "[OPTION...]",
     .help = "write the configuration of mosquitto; broker-config --help lists its options",
     .run_whole = configure_broker},
    {.words = "setup-code",
     .synopsis = "",
     .help = "print a code that makes the first account of the pages",
     .without_store = true,
     .run = make_code},
    {.words = NULL},
};
