/* What the API for administrators needs of the running hub: accounts, sessions, the worker that has
 * the database, and how doors reach the hub. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include "enroll/hub/serve/service.h"
#include "enroll/web/login/turns.h"

static int path_of(char path[PATH_MAX], const char *folder, const char *name,
                   struct iso_fault *fault)
{
    return snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX
               ? 0
               : iso_fault_set(fault, -ENAMETOOLONG, "%.64s...: the path is too long", folder);
}

/* Doors reach the hub by the first of its names. */
static int open_address(struct hub_service *service, struct iso_fault *fault)
{
    const struct hub_serve_options *options = service->options;
    const char *host = options->n_hosts > 0 ? options->hosts[0] : "localhost";

    if (snprintf(service->api_host, sizeof service->api_host, "%s", host) >=
        (int)sizeof service->api_host) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%.64s...: the name of the hub is too long",
                             host);
    }
    service->api.host = service->api_host;
    service->api.port = options->door_port;
    service->api.ca_digest = hub_ca_digest(service->ca);
    return 0;
}

int hub__administration_open(struct hub_service *service, struct iso_fault *fault)
{
    const struct hub_serve_options *options = service->options;
    struct web_login *login = &service->api.login;
    int r = path_of(service->accounts, options->folder, "accounts.json", fault);

    r = r < 0 ? r : path_of(service->setup_code, options->folder, "setup.code", fault);
    r = r < 0 ? r : open_address(service, fault);
    r = r < 0 ? r : web_accounts_open(service->accounts, &login->accounts, fault);
    r = r < 0 ? r : hub_worker_new(service->event, &options->store, &service->api.worker, fault);
    if (r < 0) {
        return r;
    }
    web_guess_init(&service->guess);
    web_guess_init(&service->scim.guess);
    login->sessions = &service->sessions;
    login->guess = &service->guess;
    login->setup_code = service->setup_code;
    hub_api_record_by_worker(&service->api);
    r = web_turns_new(service->event, login, &login->turns);
    if (r < 0) {
        return iso_fault_set(fault, r, "the event loop: %s", strerror(-r));
    }
    if (web_accounts_count(login->accounts) == 0) {
        fprintf(stderr,
                SD_NOTICE "isotherm-hub: there is no account yet; `isotherm-hub setup-code` "
                          "prints a code for the first one\n");
    }
    return 0;
}

void hub__administration_end(struct hub_service *service)
{
    hub_worker_free(service->api.worker);
    service->api.worker = NULL;
    web_turns_free(service->api.login.turns);
    service->api.login.turns = NULL;
}

void hub__administration_close(struct hub_service *service)
{
    web_accounts_close(service->api.login.accounts);
    service->api.login.accounts = NULL;
    sodium_memzero(&service->sessions, sizeof service->sessions);
}

const char *hub__administration_pages(const struct hub_service *service)
{
    const char *pages = service->options->pages;

    if (!pages || access(pages, R_OK) == 0) {
        return pages;
    }
    fprintf(stderr, SD_NOTICE "isotherm-hub: %s: there are no pages for administrators: %s\n",
            pages, strerror(errno));
    return NULL;
}
