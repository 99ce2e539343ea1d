#include "tests/enroll/hub/rigs/api_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <sodium.h>

#include "enroll/web/login/turns.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/scratch.h"

struct hub_api_rig api_rig;

static void open_accounts(void)
{
    struct iso_fault fault = {.text = ""};
    struct web_login *login = &api_rig.api.login;

    (void)snprintf(api_rig.accounts, sizeof api_rig.accounts, "%s/accounts.json",
                   (const char *)api_rig.folder);
    (void)snprintf(api_rig.setup_code, sizeof api_rig.setup_code, "%s/setup.code",
                   (const char *)api_rig.folder);
    store_rig_fine(web_accounts_open(api_rig.accounts, &login->accounts, &fault), &fault);
    web_guess_init(&api_rig.guess);
    login->sessions = &api_rig.web.sessions;
    login->guess = &api_rig.guess;
    login->setup_code = api_rig.setup_code;
    login->server = api_rig.web.server;
    hub_api_record_by_worker(&api_rig.api);
    assert_int_equal(web_turns_new(api_rig.web.event, login, &login->turns), 0);
}

int api_rig_setup(void **state)
{
    static const uint8_t digest[32] = {0xab, 0xcd};
    struct iso_fault fault = {.text = ""};

    store_rig_now_s = time(NULL);
    assert_int_equal(store_rig_setup(state), 0);
    memset(&api_rig, 0, sizeof api_rig);
    api_rig.hub = *state;
    assert_int_equal(scratch_setup(&api_rig.folder), 0);
    api_rig.options = (struct hub_store_options){.conninfo = api_rig.hub->postgres.conninfo,
                                                 .key_file = api_rig.hub->key_file,
                                                 .hub_name = "head office",
                                                 .actor = "hub"};
    api_rig.api.host = "hub.example";
    api_rig.api.port = 8444;
    api_rig.api.ca_digest = digest;
    web_rig_start(&api_rig.web, api_rig.folder, hub_api_routes, &api_rig.api);
    open_accounts();
    store_rig_fine(hub_worker_new(api_rig.web.event, &api_rig.options, &api_rig.api.worker, &fault),
                   &fault);
    for (int role = WEB_ROLE_OBSERVER; role <= WEB_ROLE_ADMINISTRATOR; role++) {
        (void)strcpy(api_rig.headers[role],
                     web_rig_login(&api_rig.web, web_role_word((enum web_role)role),
                                   (enum web_role)role, NULL));
    }
    (void)strcpy(api_rig.headers[WEB_ROLE_NONE], WEB_RIG_ORIGIN WEB_RIG_JSON);
    web_rig_connect(&api_rig.web, &api_rig.client);
    return 0;
}

int api_rig_teardown(void **state)
{
    https_close(&api_rig.client);
    hub_worker_free(api_rig.api.worker);
    web_turns_free(api_rig.api.login.turns);
    web_rig_stop(&api_rig.web);
    web_accounts_close(api_rig.api.login.accounts);
    assert_int_equal(scratch_teardown(&api_rig.folder), 0);
    return store_rig_teardown(state);
}

/* The caller frees it. */
static char *quoted(const char *body)
{
    char *text = body ? strdup(body) : NULL;

    for (char *at = text; at && *at; at++) {
        *at = *at == '\'' ? '"' : *at;
    }
    return text;
}

static void ask(enum web_role role, const char *method, const char *path, const char *body,
                struct https_answer *answer)
{
    char *text = quoted(body), whole[512];

    (void)snprintf(whole, sizeof whole, "/api/v1%s", path);
    https_ask(&api_rig.client, method, whole, api_rig.headers[role], text, answer);
    free(text);
}

json_t *api_rig_ask(enum web_role role, const char *method, const char *path, const char *body,
                    int status)
{
    struct https_answer answer;
    json_t *json = NULL;

    ask(role, method, path, body, &answer);
    if (answer.status != status) {
        fail_msg("%s %s: %d instead of %d: %s", method, path, answer.status, status, answer.body);
    }
    if (status != 204) {
        json = json_loads(answer.body, JSON_REJECT_DUPLICATES, NULL);
        assert_non_null(json);
    }
    https_answer_free(&answer);
    return json;
}

void api_rig_do(const char *method, const char *path, const char *body, int status)
{
    json_decref(api_rig_ask(WEB_ROLE_ADMINISTRATOR, method, path, body, status));
}

void api_rig_refused(enum web_role role, const char *method, const char *path, const char *body,
                     int status, const char *code)
{
    char *text = quoted(body), whole[512];

    (void)snprintf(whole, sizeof whole, "/api/v1%s", path);
    web_rig_expect(&api_rig.client, method, whole, api_rig.headers[role], text, status, code);
    free(text);
}

const json_t *api_rig_at(const json_t *json, const char *path)
{
    char copy[128], *rest = NULL;

    (void)snprintf(copy, sizeof copy, "%s", path);
    for (char *word = strtok_r(copy, ".", &rest); word; word = strtok_r(NULL, ".", &rest)) {
        json = json_is_array(json) ? json_array_get(json, (size_t)atoi(word))
                                   : json_object_get(json, word);
    }
    if (!json) {
        fail_msg("there is no %s in the answer", path);
    }
    return json;
}

const char *api_rig_text(const json_t *json, const char *path)
{
    const char *text = json_string_value(api_rig_at(json, path));

    assert_non_null(text);
    return text;
}

int64_t api_rig_number(const json_t *json, const char *path)
{
    const json_t *value = api_rig_at(json, path);

    assert_true(json_is_integer(value));
    return json_integer_value(value);
}

/* The newest act; the caller frees it. */
static char *last_act(void)
{
    json_t *acts = api_rig_ask(WEB_ROLE_ADMINISTRATOR, "GET", "/acts?max=1", NULL, 200);
    char *text = NULL;

    assert_true(asprintf(&text, "%s %s %s", api_rig_text(acts, "acts.0.actor"),
                         api_rig_text(acts, "acts.0.act"),
                         api_rig_text(acts, "acts.0.object")) > 0);
    json_decref(acts);
    return text;
}

/* Nobody waits for the record of a login, so it may come a little later. */
void api_rig_expect_act(const char *wanted)
{
    char *found = last_act();

    for (int i = 0; i < 100 && strcmp(found, wanted) != 0; i++) {
        free(found);
        found = last_act();
    }
    assert_string_equal(found, wanted);
    free(found);
}

/* Adds a door by the API, and lets the rig join with the code of its address. */
void api_rig_join(struct played_door *door, const char *name)
{
    struct iso_fault fault = {.text = ""};
    char body[160];

    *door = (struct played_door){.algorithm = 3};
    (void)crypto_sign_keypair(door->signs.public, door->signs.secret);
    (void)crypto_box_keypair(door->receives.public, door->receives.secret);
    (void)snprintf(body, sizeof body, "{'name': '%s', 'zones': ['house']}", name);
    json_t *added = api_rig_ask(WEB_ROLE_ADMINISTRATOR, "POST", "/doors", body, 201);
    const char *address = api_rig_text(added, "join.address");
    const char *code = strstr(address, "&code=");
    assert_int_equal(strncmp(address, "isotherm://hub.example:8444/?ca=abcd", 36), 0);
    assert_int_equal(strncmp(api_rig_text(added, "join.qr_svg"), "<svg ", 5), 0);
    assert_string_equal(api_rig_text(added, "state"), "waiting");
    assert_non_null(code);
    store_rig_fine(played_door_join_with(door, &api_rig.hub->store, code + 6, &fault), &fault);
    json_decref(added);
}

void api_rig_ask_hub(struct played_door *door)
{
    struct iso_fault fault = {.text = ""};

    store_rig_fine(played_door_ask(door, &api_rig.hub->store, &fault), &fault);
    played_door_fetch(door, &api_rig.hub->store);
    store_rig_fine(played_door_ask(door, &api_rig.hub->store, &fault), &fault);
}
