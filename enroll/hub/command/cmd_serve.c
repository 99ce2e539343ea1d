/* run, setup-code, broker-config. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "enroll/hub/broker/broker_config.h"
#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/serve/hub_serve.h"
#include "enroll/web/account/setup_code.h"

/* Names and addresses of a certificate: `first`, and those of [hub] hosts, which `words` receives.
 */
static size_t hosts_of(const struct hub_config *config, const char *first,
                       char words[HUB_CONFIG_TEXT_SIZE], const char *hosts[HUB_PAIR_HOSTS_MOST])
{
    char *rest = NULL;
    size_t n = 0;
    memcpy(words, config->hosts, HUB_CONFIG_TEXT_SIZE);
    if (*first) {
        hosts[n++] = first;
    }
    for (char *word = strtok_r(words, " \t", &rest); word && n < HUB_PAIR_HOSTS_MOST;
         word = strtok_r(NULL, " \t", &rest)) {
        hosts[n++] = word;
    }
    return n;
}

static int serve(struct hub_run *run)
{
    const struct hub_config *c = &run->config;
    char words[HUB_CONFIG_TEXT_SIZE];
    struct hub_serve_options options = {.store = {.conninfo = c->conninfo,
                                                  .key_file = c->key_file,
                                                  .hub_name = c->name,
                                                  .actor = "hub"},
                                        .folder = c->folder,
                                        .listen = c->listen,
                                        .door_port = (uint16_t)c->port,
                                        .pages = *c->pages ? c->pages : NULL,
                                        .broker_host = c->broker_hub_host,
                                        .broker_port = (uint16_t)c->broker_hub_port,
                                        .door_broker_host = c->broker_host,
                                        .door_broker_port = (uint16_t)c->broker_port,
                                        .broker_folder = *c->broker_folder ? c->broker_folder
                                                                           : NULL,
                                        .metrics_file = *c->metrics ? c->metrics : NULL,
                                        .home_assistant = c->home_assistant};
    if (!*c->host) {
        return iso_fault_set(&run->fault, -ENODATA, "%s: [hub] host is missing",
                             run->arguments.config);
    }
    options.n_hosts = hosts_of(c, c->host, words, options.hosts);
    return hub_serve_run(&options, &run->fault);
}

static int make_setup_code(struct hub_run *run)
{
    char path[sizeof run->config.folder + 16], code[WEB_SETUP_CODE_SIZE];
    (void)snprintf(path, sizeof path, "%s/setup.code", run->config.folder);
    const int error = web_setup_code_make(path, time(NULL), code, &run->fault);
    if (!error) {
        puts(code);
        fprintf(stderr,
                "isotherm-hub: the code makes one account of an administrator, within a day\n");
    }
    sodium_memzero(code, sizeof code);
    return error;
}

static int configure_broker(struct hub_run *run)
{
    const struct hub_config *c = &run->config;
    char words[HUB_CONFIG_TEXT_SIZE];
    const char *hosts[HUB_PAIR_HOSTS_MOST];
    const struct broker_places places = {
        .folder = run->arguments.n_words > 0 ? run->arguments.words[0] : c->broker_folder,
        .persistence = c->broker_persistence,
        .hub_address = c->broker_hub_host,
        .port = (uint16_t)c->broker_port,
        .hub_port = (uint16_t)c->broker_hub_port};
    struct hub_ca *ca = NULL;
    bool changed = false;
    if (!*places.folder) {
        return iso_fault_set(&run->fault, -EINVAL, "the folder of the broker is missing");
    }
    size_t n = hosts_of(c, c->broker_host, words, hosts);
    if (n < HUB_PAIR_HOSTS_MOST) {
        hosts[n++] = c->broker_hub_host;
    }
    int error = hub_ca_open(c->folder, &ca, &run->fault);
    error = error ? error
                  : broker_config_write(&run->store, ca, &places, hosts, n, &changed, &run->fault);
    if (!error) {
        printf("%s: %s\n", places.folder,
               changed ? "written; let mosquitto read it again" : "nothing has changed");
    }
    hub_ca_free(ca);
    return error;
}

const struct hub_command hub_serve_commands[] = {
    {"run", "", "serve the doors until the service manager ends it", 0, 0, 0, true, serve},
    {"setup-code", "", "print a code that makes the first account of the pages", 0, 0, 0, true,
     make_setup_code},
    {"broker-config", "[FOLDER]", "write the configuration of mosquitto", 0, 0, 1, false,
     configure_broker},
    {.words = NULL},
};
