/* isotherm-web: the pages of the door and its JSON API, over HTTPS. A client of the daemon, which
 * goes on without it. */
#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-daemon.h>
#include <systemd/sd-event.h>
#include <time.h>

#include "drivers/process/service_loop.h"
#include "enroll/web/account/setup_code.h"
#include "enroll/web/api/api.h"
#include "enroll/web/api/document.h"
#include "enroll/web/daemon/enrolment.h"
#include "enroll/web/daemon/feed.h"
#include "enroll/web/daemon/last_seen.h"
#include "enroll/web/first_code.h"
#include "enroll/web/listener.h"
#include "enroll/web/login/turns.h"
#include "enroll/web/options.h"
#include "enroll/web/published.h"
#include "enroll/web/update/update.h"

/* As in enroll/cli/client/fault.h. */
enum { EXIT_USAGE = 2, EXIT_NOT_FOUND = 3, EXIT_FAULT = 4 };

struct program {
    sd_event *event;
    struct web_certificate certificate;
    struct web_sessions sessions;
    struct web_guess guess;
    struct web_api api;
    struct web_first_code *first_code;
    char accounts[PATH_MAX], setup_code[PATH_MAX];
};

static int fault_exit(int error, const struct iso_fault *fault)
{
    fprintf(stderr, "isotherm-web: %s\n", fault->text);
    switch (error) {
    case -EINVAL: /* an address that is none */
        return EXIT_USAGE;
    case -ENOENT:
        return EXIT_NOT_FOUND;
    default:
        return EXIT_FAULT;
    }
}

static int path_of(char path[PATH_MAX], const char *folder, const char *name,
                   struct iso_fault *fault)
{
    if (snprintf(path, PATH_MAX, "%s/%s", folder, name) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "--state %.64s...: is too long", folder);
    }
    return 0;
}

static int open_loop(struct program *program, struct iso_fault *fault)
{
    const int r = iso_service_loop_open(&program->event);

    return r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r)) : 0;
}

/* What the program keeps on the disk. */
static int open_state(struct program *program, const struct web_options *options,
                      struct iso_fault *fault)
{
    struct web_api *api = &program->api;
    int r = path_of(program->accounts, options->state, "accounts.json", fault);

    r = r < 0 ? r : path_of(program->setup_code, options->state, "setup.code", fault);
    r = r < 0 ? r : web_accounts_open(program->accounts, &api->login.accounts, fault);
    r = r < 0 ? r : web_certificate_open(options->state, &program->certificate, fault);
    if (r < 0) {
        return r;
    }
    web_guess_init(&program->guess);
    web_api_record_by_daemon(api);
    api->login.sessions = &program->sessions;
    api->login.guess = &program->guess;
    api->login.setup_code = program->setup_code;
    api->document = (const char *)web_api_document;
    api->certificate = &program->certificate;
    if (web_accounts_count(api->login.accounts) == 0 && !options->first_code) {
        fprintf(stderr, "isotherm-web: there is no account yet; `isotherm-web setup-code` prints a "
                        "code for the first one\n");
    }
    return 0;
}

static int open_daemon(struct program *program, const struct web_options *options,
                       struct iso_fault *fault)
{
    struct web_api *api = &program->api;
    int r = web_daemon_new(program->event, options->bus, &api->daemon);

    r = r < 0 ? r : web_feed_new(program->event, api->daemon, &api->feed);
    r = r < 0 ? r : web_last_seen_new(program->event, api->daemon, &api->last_seen);
    if (r >= 0) {
        const struct web_enrolment_setup setup = {.event = program->event,
                                                  .daemon = api->daemon,
                                                  .feed = api->feed,
                                                  .sessions = &program->sessions};
        r = web_enrolment_new(&setup, &api->enrolment);
    }
    if (r >= 0) {
        const struct web_update_setup setup = {.event = program->event,
                                               .bus = options->bus,
                                               .folder = options->updates,
                                               .os_release = "/etc/os-release"};
        r = web_update_new(&setup, &api->update);
    }
    return r < 0 ? iso_fault_set(fault, r, "--bus %s: %s", options->bus, strerror(-r)) : 0;
}

static int open_first_code(struct program *program, const struct web_options *options,
                           struct iso_fault *fault)
{
    const struct web_first_code_setup setup = {.event = program->event,
                                               .accounts = program->api.login.accounts,
                                               .accounts_path = program->accounts,
                                               .code_path = program->setup_code,
                                               .makes_codes = options->first_code};
    const int r = web_first_code_new(&setup, &program->first_code);

    return r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r)) : 0;
}

static int open_server(struct program *program, const struct web_options *options,
                       struct iso_fault *fault)
{
    struct web_server_setup setup = {.event = program->event,
                                     .certificate = &program->certificate,
                                     .pages = options->pages,
                                     .sessions = &program->sessions,
                                     .routes = web_api_routes,
                                     .intakes = web_api_intakes,
                                     .context = &program->api};
    int r = web_turns_new(program->event, &program->api.login, &program->api.login.turns);

    if (r < 0) {
        return iso_fault_set(fault, r, "the event loop: %s", strerror(-r));
    }
    r = web_listener_open(options->listen, &setup.listen_fd, fault);
    return r < 0 ? r : web_server_new(&setup, &program->api.login.server, fault);
}

/* First the questions to RAUC, the calls of the daemon and the logins that still wait are answered,
 * for exchanges that have to end before the server does; then the streams end, and last those who
 * send into them. */
static void close_all(struct program *program)
{
    struct web_api *api = &program->api;

    if (api->update) {
        web_update_close(api->update);
    }
    if (api->daemon) {
        web_daemon_close(api->daemon);
    }
    web_first_code_free(program->first_code);
    web_turns_free(api->login.turns);
    web_server_free(api->login.server);
    api->login.server = NULL;
    web_update_free(api->update);
    web_enrolment_free(api->enrolment);
    web_last_seen_free(api->last_seen);
    web_feed_free(api->feed);
    web_daemon_free(api->daemon);
    web_accounts_close(api->login.accounts);
    web_certificate_free(&program->certificate);
    sd_event_unref(program->event);
    sodium_memzero(&program->sessions, sizeof program->sessions);
}

static int serve(const struct web_options *options)
{
    static struct program program;
    struct iso_fault fault = {.text = ""};
    int r = open_loop(&program, &fault);

    r = r < 0 ? r : open_state(&program, options, &fault);
    r = r < 0 ? r : open_daemon(&program, options, &fault);
    r = r < 0 ? r : open_first_code(&program, options, &fault);
    r = r < 0 ? r : open_server(&program, options, &fault);
    if (r == 0) {
        web_published_write(program.certificate.fingerprint);
        (void)sd_notify(0, "READY=1");
        r = sd_event_loop(program.event);
        (void)sd_notify(0, "STOPPING=1");
        if (r < 0) {
            (void)iso_fault_set(&fault, r, "the event loop: %s", strerror(-r));
        }
    }
    close_all(&program);
    return r < 0 ? fault_exit(r, &fault) : EXIT_SUCCESS;
}

static int print_setup_code(const struct web_options *options)
{
    char path[PATH_MAX], code[WEB_SETUP_CODE_SIZE];
    struct iso_fault fault = {.text = ""};
    int r = path_of(path, options->state, "setup.code", &fault);

    r = r < 0 ? r : web_setup_code_make(path, time(NULL), code, &fault);
    if (r < 0) {
        return fault_exit(r, &fault);
    }
    puts(code);
    fprintf(stderr, "isotherm-web: the code makes one account of an administrator, within a day\n");
    sodium_memzero(code, sizeof code);
    return EXIT_SUCCESS;
}

static int print_fingerprint(const struct web_options *options)
{
    char fingerprint[WEB_FINGERPRINT_SIZE];
    struct iso_fault fault = {.text = ""};
    const int r = web_certificate_fingerprint(options->state, fingerprint, &fault);

    if (r < 0) {
        return fault_exit(r, &fault);
    }
    puts(fingerprint);
    return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    struct web_options options;
    const int r = web_options_read(argc, argv, &options);

    if (r) {
        return r < 0 ? EXIT_USAGE : EXIT_SUCCESS;
    }
    if (sodium_init() < 0) {
        fputs("isotherm-web: libsodium cannot be initialised\n", stderr);
        return EXIT_FAULT;
    }
    switch (options.command) {
    case WEB_COMMAND_SETUP_CODE:
        return print_setup_code(&options);
    case WEB_COMMAND_FINGERPRINT:
        return print_fingerprint(&options);
    default:
        return serve(&options);
    }
}
