#include "tests/enroll/web/rigs/api_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/login/turns.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/scratch.h"

struct api_rig api_rig;

int api_rig_reply(sd_event_source *source, void *context)
{
    web_daemon_reply_fn on_reply = api_rig.on_reply;
    (void)context;

    api_rig.on_reply = NULL;
    on_reply(api_rig.context, NULL, api_rig.error);
    sd_event_source_unref(source);
    return 0;
}

void web_daemon_record(struct web_daemon *daemon, const char *account, const char *act,
                       const char *person, web_daemon_reply_fn on_reply, void *context)
{
    const size_t n = strlen(api_rig.said);
    sd_event_source *source = NULL;
    (void)daemon;

    (void)snprintf(api_rig.said + n, sizeof api_rig.said - n, "%s %s %s\n", account, act, person);
    assert_null(api_rig.on_reply);
    api_rig.on_reply = on_reply;
    api_rig.context = context;
    if (!api_rig.waits) {
        assert_true(sd_event_add_defer(api_rig.web.event, &source, api_rig_reply, NULL) >= 0);
    }
}

size_t web_daemon_waiting(const struct web_daemon *daemon)
{
    (void)daemon;
    return api_rig.n_waiting;
}

static const struct web_route routes[] = {
    {"GET", "/openapi.json", WEB_ROLE_NONE, web_api_get_document},
    {"GET", "/session", WEB_ROLE_NONE, web_login_get_session},
    {"POST", "/session", WEB_ROLE_NONE, web_login_log_in},
    {"DELETE", "/session", WEB_ROLE_NONE, web_login_log_out},
    {"PUT", "/session/password", WEB_ROLE_OBSERVER, web_login_set_own_password},
    {"POST", "/setup", WEB_ROLE_NONE, web_login_set_up},
    {"GET", "/accounts", WEB_ROLE_ADMINISTRATOR, web_login_list_accounts},
    {"POST", "/accounts", WEB_ROLE_ADMINISTRATOR, web_login_add_account},
    {"PATCH", "/accounts/{name}", WEB_ROLE_ADMINISTRATOR, web_login_change_account},
    {"DELETE", "/accounts/{name}", WEB_ROLE_ADMINISTRATOR, web_login_remove_account},
    {"GET", "/update", WEB_ROLE_ADMINISTRATOR, web_api_get_update},
    {"POST", "/update", WEB_ROLE_ADMINISTRATOR, web_api_take_update},
    {"POST", "/update/restart", WEB_ROLE_ADMINISTRATOR, web_api_restart},
    {NULL, NULL, WEB_ROLE_NONE, NULL},
};

int api_rig_setup(void **state)
{
    struct iso_fault fault = {.text = ""};

    assert_int_equal(scratch_setup(state), 0);
    memset(&api_rig, 0, sizeof api_rig);
    web_rig_start(&api_rig.web, *state, routes, &api_rig.api);
    web_guess_init(&api_rig.guess);
    (void)snprintf(api_rig.setup_code, sizeof api_rig.setup_code, "%s/setup.code",
                   (const char *)*state);
    (void)snprintf(api_rig.accounts_path, sizeof api_rig.accounts_path, "%s/accounts.json",
                   (const char *)*state);
    assert_int_equal(web_accounts_open(api_rig.accounts_path, &api_rig.api.login.accounts, &fault),
                     0);
    api_rig.api.login.sessions = &api_rig.web.sessions;
    api_rig.api.login.guess = &api_rig.guess;
    api_rig.api.login.setup_code = api_rig.setup_code;
    api_rig.api.document = "{\"openapi\": \"3.1.0\"}";
    web_api_record_by_daemon(&api_rig.api);
    api_rig.api.login.server = api_rig.web.server;
    assert_int_equal(web_turns_new(api_rig.web.event, &api_rig.api.login, &api_rig.api.login.turns),
                     0);
    web_rig_connect(&api_rig.web, &api_rig.client);
    return 0;
}

int api_rig_teardown(void **state)
{
    https_close(&api_rig.client);
    web_turns_free(api_rig.api.login.turns);
    web_rig_stop(&api_rig.web);
    web_accounts_close(api_rig.api.login.accounts);
    return scratch_teardown(state);
}

void api_rig_add_account(const char *name, enum web_role role)
{
    struct iso_fault fault = {.text = ""};

    assert_int_equal(web_accounts_add(api_rig.api.login.accounts, name, PASSWORD, role, &fault), 0);
}

char *api_rig_log_in(const char *path, const char *body)
{
    struct https_answer answer;
    char *headers = NULL;

    https_ask(&api_rig.client, "POST", path, WEB_RIG_ORIGIN WEB_RIG_JSON, body, &answer);
    if (answer.status != 201) {
        fail_msg("%d %s", answer.status, answer.body);
    }
    const char *cookie = https_header(&answer, "Set-Cookie");
    assert_non_null(cookie);
    assert_non_null(strstr(cookie, "; Secure; HttpOnly; SameSite=Strict"));
    assert_true(asprintf(&headers, WEB_RIG_ORIGIN WEB_RIG_JSON "Cookie: %.*s\r\n",
                         (int)strcspn(cookie, ";"), cookie) > 0);
    https_answer_free(&answer);
    return headers;
}

char *api_rig_log_in_as(const char *name)
{
    char body[256];

    (void)snprintf(body, sizeof body, "{\"account\":\"%s\",\"password\":\"" PASSWORD "\"}", name);
    return api_rig_log_in("/api/v1/session", body);
}

void api_rig_expect(const char *method, const char *path, const char *headers, const char *body,
                    int status, const char *code)
{
    web_rig_expect(&api_rig.client, method, path, headers, body, status, code);
}

void api_rig_expect_body(const char *method, const char *path, const char *headers, int status,
                         const char *body)
{
    struct https_answer answer;

    https_ask(&api_rig.client, method, path, headers, NULL, &answer);
    assert_int_equal(answer.status, status);
    assert_string_equal(answer.body, body);
    https_answer_free(&answer);
}
