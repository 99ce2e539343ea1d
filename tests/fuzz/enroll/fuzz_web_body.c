/* The members of bodies: every route of the API that has a body gets JSON objects. The handlers,
 * the accounts and the enrolment are the real ones; the exchange and the daemon are stand-ins.
 *
 * The first byte of an input chooses the route, the second what the path names and what the daemon
 * answers, and the rest is the body. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "enroll/web/api/api.h"
#include "enroll/web/daemon/enrolment.h"
#include "enroll/web/daemon/feed.h"
#include "enroll/web/daemon/last_seen.h"
#include "enroll/web/http/now.h"
#include "enroll/web/login/turns.h"
#include "enroll/web/update/update.h"
#include "firmware/contract/contract.h"
#include "tests/fuzz/enroll/web_stand_in.h"
#include "tests/fuzz/fuzz.h"

enum { ANSWERS_MOST = 64 };

/* Ada is the only administrator. The hashes are of no password. */
static const char accounts_text[] = "{\"version\": 1, \"accounts\": ["
                                    "{\"name\": \"ada\", \"role\": \"administrator\", \"hash\": "
                                    "\"$argon2id$v=19$m=19456,t=2,p=1$AAAAAAAAAAAAAAAAAAAAAA$"
                                    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA\"},"
                                    "{\"name\": \"eve\", \"role\": \"observer\", \"hash\": "
                                    "\"$argon2id$v=19$m=19456,t=2,p=1$AAAAAAAAAAAAAAAAAAAAAA$"
                                    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA\"}]}";

static const char *const parts[] = {"ada", "eve", "nobody", "Ada Lovelace"};

struct world {
    char accounts[64];
    sd_event *event;
    struct web_sessions sessions;
    struct web_guess guess;
    struct web_api api;
    const struct web_route *routes[32]; /* those with a body */
    size_t n_routes;
    uint64_t session;
};

static struct world world;

static void begin_session(void)
{
    const struct web_account account = {.name = "ada", .role = WEB_ROLE_ADMINISTRATOR};
    char token[WEB_SESSION_TOKEN_SIZE];
    world.session = web_session_begin(&world.sessions, &account, web_now_ns(), token);
}

static void open_accounts(void)
{
    struct iso_fault fault;
    FILE *file = fopen(world.accounts, "we");
    fuzz_check(file && fputs(accounts_text, file) >= 0 && fclose(file) == 0, "a file is written");
    web_accounts_close(world.api.login.accounts);
    fuzz_check(web_accounts_open(world.accounts, &world.api.login.accounts, &fault) == 0,
               "the accounts can be read");
}

static void begin_world(void)
{
    struct web_api *api = &world.api;
    const char *folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    (void)snprintf(world.accounts, sizeof world.accounts, "%s/isotherm-fuzz-%d.json", folder,
                   (int)getpid());
    fuzz_check(sd_event_new(&world.event) >= 0, "there is an event loop");
    fuzz_check(web_daemon_new(world.event, "", &api->daemon) == 0, "there is a stand-in");
    web_api_record_by_daemon(api);
    api->login.sessions = &world.sessions;
    web_guess_init(&world.guess);
    api->login.guess = &world.guess;
    api->login.setup_code = "/nonexistent/setup.code";
    fuzz_check(web_feed_new(world.event, api->daemon, &api->feed) == 0 &&
                   web_last_seen_new(world.event, api->daemon, &api->last_seen) == 0 &&
                   web_turns_new(world.event, &api->login, &api->login.turns) == 0,
               "the parts are made");
    const struct web_enrolment_setup setup = {.event = world.event,
                                              .daemon = api->daemon,
                                              .feed = api->feed,
                                              .sessions = &world.sessions};
    fuzz_check(web_enrolment_new(&setup, &api->enrolment) == 0, "the enrolment is made");
    /* A machine without an image: RAUC is never asked. */
    const struct web_update_setup update = {
        .event = world.event, .bus = "", .folder = "/nonexistent", .os_release = "/nonexistent"};
    fuzz_check(web_update_new(&update, &api->update) == 0, "the updates are made");
    open_accounts();
    begin_session();
    for (const struct web_route *route = web_api_routes; route->method; route++) {
        if (strcmp(route->method, "POST") == 0 || strcmp(route->method, "PUT") == 0 ||
            strcmp(route->method, "PATCH") == 0) {
            world.routes[world.n_routes++] = route;
        }
    }
    fuzz_check(world.n_routes >= 8, "the routes with a body are found");
}

/* Whether the accounts are those of the file. */
static bool accounts_are_as_before(void)
{
    const struct web_account *ada = web_accounts_find(world.api.login.accounts, "ada");
    const struct web_account *eve = web_accounts_find(world.api.login.accounts, "eve");
    return web_accounts_count(world.api.login.accounts) == 2 && ada && eve &&
           ada->role == WEB_ROLE_ADMINISTRATOR && eve->role == WEB_ROLE_OBSERVER &&
           strstr(accounts_text, ada->hash) && strstr(accounts_text, eve->hash);
}

/* Whether a body names a consent. */
static bool consents(const json_t *body)
{
    return json_is_true(json_object_get(body, "consent"));
}

static void check_answer(const struct web_exchange *exchange, const json_t *body)
{
    const struct web_stand_in *daemon = &web_stand_in;
    fuzz_check(exchange->answers == 1, "an exchange is answered once");
    if (exchange->status >= 400 && exchange->status < 500) {
        fuzz_check(accounts_are_as_before(), "a refused body changes no account");
        fuzz_check(daemon->n_records == 0 && daemon->n_calls == 0,
                   "a refused body neither records nor changes anything");
    }
    fuzz_check(daemon->n_calls == 0 || daemon->n_records > 0 || !daemon->changes,
               "a change is put on record before it is made");
    fuzz_check(!daemon->claimed || consents(body), "nobody is enrolled without a consent");
    fuzz_check(web_accounts_find(world.api.login.accounts, "ada") != NULL &&
                   web_accounts_find(world.api.login.accounts, "ada")->role ==
                       WEB_ROLE_ADMINISTRATOR,
               "the last administrator stays");
}

static void ask(const struct web_route *route, uint8_t choice, json_t *body)
{
    struct web_exchange exchange = {.part = parts[choice % 4],
                                    .body = body,
                                    .account = "ada",
                                    .role = WEB_ROLE_ADMINISTRATOR,
                                    .session = world.session};
    web_stand_in_reset((choice & 4) != 0);
    route->handle(&world.api, &exchange);
    for (int i = 0; i < ANSWERS_MOST && (exchange.answers == 0 || web_stand_in.n_due > 0); i++) {
        web_stand_in_answer();
        fuzz_check(sd_event_run(world.event, 0) >= 0, "the loop runs");
    }
    check_answer(&exchange, body);
    json_decref(exchange.json);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (!world.event) {
        begin_world();
    }
    if (size < 2) {
        return 0;
    }
    json_t *body = json_loadb((const char *)data + 2, size - 2, JSON_REJECT_DUPLICATES, NULL);
    if (json_is_object(body)) {
        ask(world.routes[data[0] % world.n_routes], data[1], body);
        if (!accounts_are_as_before()) {
            open_accounts();
        }
        if (!web_session_goes_on(&world.sessions, world.session, web_now_ns())) {
            begin_session();
        }
        web_guess_init(&world.guess);
    }
    json_decref(body);
    return 0;
}
