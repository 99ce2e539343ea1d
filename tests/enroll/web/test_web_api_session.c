/* Login and setup by the API. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/account/setup_code.h"
#include "enroll/web/http/now.h"
#include "tests/enroll/web/rigs/api_rig.h"

/* Whether the problem of GET /session says that there is no account yet. */
static bool says_setup(void)
{
    struct https_answer answer;

    https_ask(&api_rig.client, "GET", "/api/v1/session", "", NULL, &answer);
    assert_int_equal(answer.status, 401);
    assert_string_equal(https_header(&answer, "Content-Type"), "application/problem+json");
    json_t *json = json_loads(answer.body, 0, NULL);
    const json_t *flag = json_object_get(json, "setup");
    assert_true(json_is_boolean(flag));
    assert_string_equal(json_string_value(json_object_get(json, "code")), "login-required");
    const bool value = json_is_true(flag);
    json_decref(json);
    https_answer_free(&answer);
    return value;
}

static void a_person_logs_in_and_out(void **state)
{
    (void)state;
    assert_true(says_setup());
    api_rig_add_account("ada", WEB_ROLE_ENROLLER);
    assert_false(says_setup());
    char *headers = api_rig_log_in_as("ada");
    api_rig_expect_body("GET", "/api/v1/session", headers, 200,
                        "{\"account\":\"ada\",\"role\":\"enroller\"}");
    api_rig_expect("GET", "/api/v1/accounts", headers, NULL, 403, "not-allowed");
    api_rig_expect("DELETE", "/api/v1/session", headers, NULL, 204, NULL);
    api_rig_expect("GET", "/api/v1/session", headers, NULL, 401, "login-required");
    api_rig_expect("DELETE", "/api/v1/session", headers, NULL, 204, NULL);
    api_rig_expect("DELETE", "/api/v1/session", "", NULL, 403, "other-origin");
    assert_string_equal(api_rig.said, "ada login \nada logout \n");
    free(headers);
}

static void a_new_login_ends_the_session_before(void **state)
{
    struct https_answer answer;
    (void)state;

    api_rig_add_account("ada", WEB_ROLE_ENROLLER);
    char *headers = api_rig_log_in_as("ada");
    https_ask(&api_rig.client, "POST", "/api/v1/session", headers,
              "{\"account\":\"ada\",\"password\":\"" PASSWORD "\"}", &answer);
    assert_int_equal(answer.status, 201);
    https_answer_free(&answer);
    api_rig_expect("GET", "/api/v1/session", headers, NULL, 401, "login-required");
    free(headers);
}

static void a_login_works_without_the_daemon(void **state)
{
    const sd_bus_error gone = {.name = SD_BUS_ERROR_SERVICE_UNKNOWN, .message = "gone"};
    (void)state;

    api_rig_add_account("ada", WEB_ROLE_OBSERVER);
    api_rig.error = &gone;
    char *headers = api_rig_log_in_as("ada");
    api_rig_expect("GET", "/api/v1/session", headers, NULL, 200, NULL);
    free(headers);
}

/* Processor time of server and client, which other work of the machine does not change. */
static double seconds_of(const char *body)
{
    struct timespec begin, end;

    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
    api_rig_expect("POST", "/api/v1/session", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 401,
                   "wrong-password");
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    return (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
}

static void a_wrong_password_is_refused_and_slowed_down(void **state)
{
    static const char wrong[] = "{\"account\":\"ada\",\"password\":\"wrong\"}";
    static const char unknown[] = "{\"account\":\"nobody\",\"password\":\"wrong\"}";
    struct https_answer answer;
    (void)state;

    api_rig_add_account("ada", WEB_ROLE_OBSERVER);
    const double known_s = seconds_of(wrong), unknown_s = seconds_of(unknown);
    assert_true(unknown_s > 0.3 * known_s);
    (void)seconds_of(wrong);
    https_ask(&api_rig.client, "POST", "/api/v1/session", WEB_RIG_ORIGIN WEB_RIG_JSON,
              "{\"account\":\"ada\",\"password\":\"" PASSWORD "\"}", &answer);
    assert_int_equal(answer.status, 429);
    assert_string_equal(https_header(&answer, "Retry-After"), "1");
    https_answer_free(&answer);
    assert_string_equal(api_rig.said, "");
}

/* The record after those that were left out says how many they were. */
static void logins_beyond_a_limit_are_counted(void **state)
{
    (void)state;
    api_rig_add_account("ada", WEB_ROLE_OBSERVER);
    api_rig.api.login.notes.items[0] = (struct web_note_count){
        .account = "ada", .used = 1.5, .last_ns = web_now_ns(), .left_out = 17};
    free(api_rig_log_in_as("ada"));
    assert_string_equal(api_rig.said, "ada login-after-17 \n");
}

static const char wrong_login[] =
    "POST /api/v1/session HTTP/1.1\r\nHost: door.test\r\n" WEB_RIG_ORIGIN WEB_RIG_JSON
    "Content-Length: 36\r\n\r\n{\"account\":\"ada\",\"password\":\"wrong\"}";

static unsigned failures(void)
{
    unsigned n = 0;

    for (int i = 0; i < WEB_GUESS_ADDRESSES; i++) {
        n += api_rig.guess.addresses[i].failures;
    }
    return n;
}

static int status_of(struct https *client)
{
    struct https_answer answer;

    https_read(client, &answer);
    https_answer_free(&answer);
    https_close(client);
    return answer.status;
}

static void passwords_are_checked_one_after_the_other(void **state)
{
    enum { LOGINS = 6 };
    struct https clients[LOGINS];
    int n_wrong = 0, n_early = 0;
    (void)state;

    for (int i = 0; i < LOGINS; i++) {
        web_rig_connect(&api_rig.web, &clients[i]);
    }
    for (int i = 0; i < LOGINS; i++) {
        https_send(&clients[i], wrong_login);
    }
    for (unsigned before = 0; before < WEB_GUESS_FREE; before = failures()) {
        https_pump(api_rig.web.event, -1);
        assert_in_range(failures(), before, before + 1);
    }
    for (int i = 0; i < LOGINS; i++) {
        const int status = status_of(&clients[i]);
        n_wrong += status == 401;
        n_early += status == 429;
    }
    assert_int_equal(n_wrong, WEB_GUESS_FREE);
    assert_int_equal(n_early, LOGINS - WEB_GUESS_FREE);
    assert_int_equal(failures(), WEB_GUESS_FREE);
}

static void nobody_logs_in_while_too_many_calls_wait(void **state)
{
    (void)state;
    api_rig_add_account("ada", WEB_ROLE_OBSERVER);
    api_rig.n_waiting = 40;
    api_rig_expect("POST", "/api/v1/session", WEB_RIG_ORIGIN WEB_RIG_JSON,
                   "{\"account\":\"ada\",\"password\":\"" PASSWORD "\"}", 503, "daemon-busy");
    assert_string_equal(api_rig.said, "");
    api_rig.n_waiting = 39;
    free(api_rig_log_in_as("ada"));
}

static void members_of_a_login_are_checked(void **state)
{
    static const char *const bodies[] = {
        "{}", "{\"account\":\"ada\"}", "{\"account\":1,\"password\":\"x\"}",
        "{\"account\":\"\",\"password\":\"x\"}",
        "{\"account\":\"abcdefghijklmnopqrstuvwxyz0123456\",\"password\":\"x\"}"};
    (void)state;

    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
        api_rig_expect("POST", "/api/v1/session", WEB_RIG_ORIGIN WEB_RIG_JSON, bodies[i], 400,
                       "invalid-member");
    }
    api_rig_expect("POST", "/api/v1/session", WEB_RIG_ORIGIN, NULL, 400, "invalid-member");
}

static void the_code_makes_one_administrator(void **state)
{
    char code[WEB_SETUP_CODE_SIZE], body[512];
    struct iso_fault fault = {.text = ""};
    (void)state;

    assert_int_equal(web_setup_code_make(api_rig.setup_code, time(NULL), code, &fault), 0);
    api_rig_expect(
        "POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON,
        "{\"code\":\"00000-00000-00000-00000\",\"account\":\"ada\",\"password\":\"" PASSWORD "\"}",
        401, "wrong-code");
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"Ada\",\"password\":\"%s\"}",
                   code, PASSWORD);
    api_rig_expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 400,
                   "invalid-account");
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"ada\",\"password\":\"%s\"}",
                   code, "short");
    api_rig_expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 400,
                   "invalid-password");
    api_rig_add_account("ada", WEB_ROLE_OBSERVER);
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"ada\",\"password\":\"%s\"}",
                   code, PASSWORD);
    api_rig_expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 409,
                   "account-exists");
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"bob\",\"password\":\"%s\"}",
                   code, PASSWORD);
    char *headers = api_rig_log_in("/api/v1/setup", body);
    api_rig_expect_body("GET", "/api/v1/accounts", headers, 200,
                        "{\"accounts\":[{\"name\":\"ada\",\"role\":\"observer\"},"
                        "{\"name\":\"bob\",\"role\":\"administrator\"}]}");
    assert_string_equal(api_rig.said, "bob setup \n");
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"eve\",\"password\":\"%s\"}",
                   code, PASSWORD);
    api_rig_expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 401, "wrong-code");
    free(headers);
}

static void an_own_password_is_changed(void **state)
{
    (void)state;
    api_rig_add_account("ada", WEB_ROLE_OBSERVER);
    char *own = api_rig_log_in_as("ada"), *elsewhere = api_rig_log_in_as("ada");
    const char *path = "/api/v1/session/password";
    api_rig_expect("PUT", path, own, "{\"old\":\"wrong\",\"new\":\"" OTHER "\"}", 401,
                   "wrong-password");
    api_rig_expect("PUT", path, own, "{\"old\":\"" PASSWORD "\",\"new\":\"short\"}", 400,
                   "invalid-password");
    api_rig_expect("PUT", path, own, "{\"old\":\"" PASSWORD "\",\"new\":\"" OTHER "\"}", 204, NULL);
    api_rig_expect("GET", "/api/v1/session", own, NULL, 200, NULL);
    api_rig_expect("GET", "/api/v1/session", elsewhere, NULL, 401, "login-required");
    assert_true(web_password_is(OTHER, web_accounts_find(api_rig.api.login.accounts, "ada")->hash));
    assert_string_equal(api_rig.said, "ada login \nada login \nada password-change \n");
    free(own);
    free(elsewhere);
}

static void the_document_is_served(void **state)
{
    (void)state;
    api_rig_expect_body("GET", "/api/v1/openapi.json", "", 200, "{\"openapi\": \"3.1.0\"}");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, api_rig_setup, api_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(logins_beyond_a_limit_are_counted),
        TEST(a_person_logs_in_and_out),
        TEST(a_new_login_ends_the_session_before),
        TEST(a_login_works_without_the_daemon),
        TEST(a_wrong_password_is_refused_and_slowed_down),
        TEST(passwords_are_checked_one_after_the_other),
        TEST(nobody_logs_in_while_too_many_calls_wait),
        TEST(members_of_a_login_are_checked),
        TEST(the_code_makes_one_administrator),
        TEST(an_own_password_is_changed),
        TEST(the_document_is_served),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
