/* What the web server checks before it calls a handler, and what the handler learns. */
#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/web/rigs/web_rig.h"
#include "tests/support/scratch.h"

static struct web_rig rig;

static void echo(void *context, struct web_exchange *exchange)
{
    const char *part = web_exchange_part(exchange), *query = web_exchange_query(exchange, "q");
    int64_t number;

    assert_ptr_equal(context, &rig);
    if (!web_exchange_number(exchange, "n", -2, 10, 7, &number)) {
        return;
    }
    web_exchange_json(exchange, 200,
                      json_pack("{s:s*, s:s*, s:I, s:s, s:s, s:O, s:i}", "part", part, "q", query,
                                "n", (json_int_t)number, "account", web_exchange_account(exchange),
                                "role", web_role_word(web_exchange_role(exchange)), "body",
                                web_exchange_body(exchange), "family",
                                web_exchange_address(exchange)->sa_family));
}

static void done(void *context, struct web_exchange *exchange)
{
    (void)context;
    web_exchange_header(exchange, "Retry-After", "3");
    web_exchange_done(exchange);
}

static struct web_exchange *waiting[WEB_REQUESTS_OF_ACCOUNT];
static int n_waiting;

/* Answers later. */
static void answer_later(void *context, struct web_exchange *exchange)
{
    (void)context;
    assert_true(n_waiting < WEB_REQUESTS_OF_ACCOUNT);
    waiting[n_waiting++] = exchange;
}

static const struct web_route routes[] = {
    {"GET", "/wait", WEB_ROLE_OBSERVER, answer_later},
    {"GET", "/echo", WEB_ROLE_NONE, echo},
    {"POST", "/echo", WEB_ROLE_NONE, echo},
    {"GET", "/people/{name}", WEB_ROLE_NONE, echo},
    {"DELETE", "/people/{name}", WEB_ROLE_ADMINISTRATOR, done},
    {"PATCH", "/people/{name}", WEB_ROLE_ENROLLER, echo},
    {"GET", "/people/{name}/credential", WEB_ROLE_NONE, echo},
    {NULL, NULL, WEB_ROLE_NONE, NULL},
};

static int setup(void **state)
{
    assert_int_equal(scratch_setup(state), 0);
    web_rig_start(&rig, *state, routes, &rig);
    return 0;
}

static int teardown(void **state)
{
    web_rig_stop(&rig);
    return scratch_teardown(state);
}

static void each_check_has_its_problem(void **state)
{
    static const struct {
        const char *method, *path, *headers, *body;
        int status;
        const char *code;
    } cases[] = {
        {"GET", "/api/v1/none", "", NULL, 404, "no-such-path"},
        {"GET", "/api/v1/", "", NULL, 404, "no-such-path"},
        {"GET", "/api/v1/people/", "", NULL, 404, "no-such-path"},
        {"GET", "/api/v1/people/a/b", "", NULL, 404, "no-such-path"},
        {"GET", "/api/v1/people/%80", "", NULL, 404, "no-such-path"},
        {"PUT", "/api/v1/echo", WEB_RIG_ORIGIN, NULL, 405, "no-such-method"},
        {"POST", "/api/v1/echo", WEB_RIG_JSON, "{}", 403, "other-origin"},
        {"POST", "/api/v1/echo", "Origin: https://evil.test\r\n" WEB_RIG_JSON, "{}", 403,
         "other-origin"},
        {"POST", "/api/v1/echo", "Sec-Fetch-Site: same-site\r\n" WEB_RIG_JSON, "{}", 403,
         "other-origin"},
        {"GET", "/api/v1/echo", "Sec-Fetch-Site: cross-site\r\n", NULL, 403, "other-origin"},
        {"POST", "/api/v1/echo", WEB_RIG_ORIGIN, "{}", 415, "no-json"},
        {"POST", "/api/v1/echo", WEB_RIG_ORIGIN "Content-Type: text/plain\r\n", "{}", 415,
         "no-json"},
        {"POST", "/api/v1/echo", WEB_RIG_ORIGIN "Content-Type: application/jsonp\r\n", "{}", 415,
         "no-json"},
        {"POST", "/api/v1/echo", WEB_RIG_ORIGIN WEB_RIG_JSON, "{", 400, "invalid-json"},
        {"POST", "/api/v1/echo", WEB_RIG_ORIGIN WEB_RIG_JSON, "[1]", 400, "invalid-json"},
        {"POST", "/api/v1/echo", WEB_RIG_ORIGIN WEB_RIG_JSON, "{\"a\":1,\"a\":2}", 400,
         "invalid-json"},
        {"POST", "/api/v1/echo", WEB_RIG_ORIGIN WEB_RIG_JSON, "{\"a\":\"\xff\"}", 400,
         "invalid-json"},
        {"GET", "/api/v1/echo?n=11", "", NULL, 400, "invalid-parameter"},
        {"GET", "/api/v1/echo?n=-3", "", NULL, 400, "invalid-parameter"},
        {"GET", "/api/v1/echo?n=", "", NULL, 400, "invalid-parameter"},
        {"GET", "/api/v1/echo?n=1x", "", NULL, 400, "invalid-parameter"},
        {"GET", "/api/v1/echo?n=+1", "", NULL, 400, "invalid-parameter"},
        {"GET", "/api/v1/echo?n=99999999999999999999", "", NULL, 400, "invalid-parameter"},
        {"GET", "/api/v1/echo?q=%0", "", NULL, 400, "invalid-parameter"},
        {"GET", "/api/v1/echo?q=1&q=2", "", NULL, 400, "invalid-parameter"},
        {"DELETE", "/api/v1/people/ada", WEB_RIG_ORIGIN, NULL, 401, "login-required"},
    };
    struct https client;
    (void)state;

    web_rig_connect(&rig, &client);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        web_rig_expect(&client, cases[i].method, cases[i].path, cases[i].headers, cases[i].body,
                       cases[i].status, cases[i].code);
    }
    https_close(&client);
}

static void a_role_is_necessary_and_sufficient(void **state)
{
    struct https client;
    uint64_t id;
    char old[512];
    (void)state;

    web_rig_connect(&rig, &client);
    const char *headers = web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL);
    web_rig_expect(&client, "PATCH", "/api/v1/people/ada", headers, "{}", 403, "not-allowed");
    headers = web_rig_login(&rig, "bob", WEB_ROLE_ENROLLER, NULL);
    web_rig_expect(&client, "PATCH", "/api/v1/people/ada", headers, "{}", 200, NULL);
    web_rig_expect(&client, "DELETE", "/api/v1/people/ada", headers, NULL, 403, "not-allowed");
    headers = web_rig_login(&rig, "ada", WEB_ROLE_ADMINISTRATOR, &id);
    (void)snprintf(old, sizeof old, "%s", headers);
    web_rig_expect(&client, "DELETE", "/api/v1/people/ada", headers, NULL, 204, NULL);
    web_session_end(&rig.sessions, id);
    web_rig_expect(&client, "DELETE", "/api/v1/people/ada", old, NULL, 401, "login-required");
    https_close(&client);
}

static void one_account_does_not_keep_the_others_waiting(void **state)
{
    struct https clients[WEB_REQUESTS_OF_ACCOUNT], client;
    struct https_answer answer;
    char request[1024];
    (void)state;

    const char *headers = web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL);
    (void)snprintf(request, sizeof request,
                   "GET /api/v1/wait HTTP/1.1\r\nHost: door.test\r\n%s\r\n", headers);
    for (int i = 0; i < WEB_REQUESTS_OF_ACCOUNT; i++) {
        web_rig_connect(&rig, &clients[i]);
        https_send(&clients[i], request);
        for (int n = 0; n_waiting <= i; n++) {
            assert_true(n < 500);
            https_pump(rig.event, -1);
        }
    }
    web_rig_connect(&rig, &client);
    web_rig_expect(&client, "GET", "/api/v1/echo", headers, NULL, 503, "busy");
    web_rig_expect(&client, "GET", "/api/v1/echo", "", NULL, 200, NULL);
    web_rig_expect(&client, "GET", "/api/v1/echo",
                   web_rig_login(&rig, "bob", WEB_ROLE_OBSERVER, NULL), NULL, 200, NULL);
    for (int i = 0; i < WEB_REQUESTS_OF_ACCOUNT; i++) {
        web_exchange_done(waiting[i]);
        https_read(&clients[i], &answer);
        assert_int_equal(answer.status, 204);
        https_answer_free(&answer);
        https_close(&clients[i]);
    }
    headers = web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL);
    web_rig_expect(&client, "GET", "/api/v1/echo", headers, NULL, 200, NULL);
    https_close(&client);
}

static void a_handler_learns_the_request(void **state)
{
    struct https client;
    struct https_answer answer;
    (void)state;

    web_rig_connect(&rig, &client);
    https_ask(&client, "PATCH", "/api/v1/people/J%C3%BCrgen%2FM?q=a+b%2B&n=-2&x",
              web_rig_login(&rig, "bob", WEB_ROLE_ENROLLER, NULL), "{\"k\": [1, 2]}", &answer);
    json_t *json = json_loads(answer.body, 0, NULL);
    assert_non_null(json);
    assert_string_equal(json_string_value(json_object_get(json, "part")), "J\xc3\xbcrgen/M");
    assert_string_equal(json_string_value(json_object_get(json, "q")), "a b+");
    assert_int_equal(json_integer_value(json_object_get(json, "n")), -2);
    assert_string_equal(json_string_value(json_object_get(json, "account")), "bob");
    assert_string_equal(json_string_value(json_object_get(json, "role")), "enroller");
    assert_int_equal(json_array_size(json_object_get(json_object_get(json, "body"), "k")), 2);
    assert_int_equal(json_integer_value(json_object_get(json, "family")), AF_INET);
    assert_string_equal(https_header(&answer, "Cache-Control"), "no-store");
    assert_string_equal(https_header(&answer, "Content-Type"), "application/json");
    web_rig_check_headers(&answer);
    json_decref(json);
    https_answer_free(&answer);
    https_close(&client);
}

static void a_name_may_be_in_the_middle_of_a_path(void **state)
{
    static const char *const others[] = {
        "/api/v1/people//credential",
        "/api/v1/people/ada/credentials",
        "/api/v1/people/ada/x/credential",
        "/api/v1/people/ada/credential/",
        "/api/v1/people/ada/",
    };
    struct https client;
    struct https_answer answer;
    (void)state;

    web_rig_connect(&rig, &client);
    https_ask(&client, "GET", "/api/v1/people/J%C3%BCrgen%2FM/credential?q=a", WEB_RIG_ORIGIN, NULL,
              &answer);
    json_t *json = json_loads(answer.body, 0, NULL);
    assert_string_equal(json_string_value(json_object_get(json, "part")), "J\xc3\xbcrgen/M");
    assert_string_equal(json_string_value(json_object_get(json, "q")), "a");
    json_decref(json);
    https_answer_free(&answer);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        web_rig_expect(&client, "GET", others[i], WEB_RIG_ORIGIN, NULL, 404, "no-such-path");
    }
    https_close(&client);
}

static void a_method_that_is_missing_names_those_that_exist(void **state)
{
    struct https client;
    struct https_answer answer;
    (void)state;

    web_rig_connect(&rig, &client);
    https_ask(&client, "POST", "/api/v1/people/ada", WEB_RIG_ORIGIN, NULL, &answer);
    assert_int_equal(answer.status, 405);
    assert_string_equal(https_header(&answer, "Allow"), "GET, DELETE, PATCH");
    web_rig_check_headers(&answer);
    https_answer_free(&answer);
    https_ask(&client, "DELETE", "/api/v1/people/ada",
              web_rig_login(&rig, "ada", WEB_ROLE_ADMINISTRATOR, NULL), NULL, &answer);
    assert_int_equal(answer.status, 204);
    assert_string_equal(https_header(&answer, "Retry-After"), "3");
    web_rig_check_headers(&answer);
    https_answer_free(&answer);
    https_close(&client);
}

static void a_body_has_a_limit(void **state)
{
    const size_t n = WEB_BODY_MOST_BYTES;
    char *body = malloc(n + 2);
    struct https client;
    (void)state;

    memset(body, ' ', n + 1);
    body[0] = '{';
    body[n - 1] = '}';
    body[n] = '\0';
    web_rig_connect(&rig, &client);
    web_rig_expect(&client, "POST", "/api/v1/echo", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 200, NULL);
    body[n] = ' ';
    body[n + 1] = '\0';
    web_rig_expect(&client, "POST", "/api/v1/echo", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 413,
                   "too-large");
    https_close(&client);
    free(body);
}

/* The length of a body that comes in chunks is not known before. */
static void a_body_in_chunks_has_the_same_limit(void **state)
{
    static const char head[] =
        "POST /api/v1/echo HTTP/1.1\r\nHost: door.test\r\n" WEB_RIG_ORIGIN WEB_RIG_JSON
        "Transfer-Encoding: chunked\r\n\r\n";
    char chunk[4096 + 16];
    struct https client;
    struct https_answer answer;
    (void)state;

    web_rig_connect(&rig, &client);
    https_send(&client, head);
    https_send(&client, "1\r\n{\r\n1\r\n}\r\n0\r\n\r\n");
    https_read(&client, &answer);
    assert_int_equal(answer.status, 200);
    https_answer_free(&answer);
    (void)snprintf(chunk, sizeof chunk, "1000\r\n%4096s\r\n", "");
    https_send(&client, head);
    for (int i = 0; i < WEB_BODY_MOST_BYTES / 4096 + 1; i++) {
        https_send(&client, chunk);
    }
    https_send(&client, "0\r\n\r\n");
    https_read(&client, &answer);
    assert_int_equal(answer.status, 413);
    web_rig_check_headers(&answer);
    https_answer_free(&answer);
    https_close(&client);
}

static void requests_without_host_or_of_great_length_are_refused(void **state)
{
    struct https client;
    struct https_answer answer;
    char path[WEB_BODY_MOST_BYTES / 16];
    (void)state;

    web_rig_connect(&rig, &client);
    memset(path, 'a', sizeof path - 1);
    path[0] = '/';
    path[sizeof path - 1] = '\0';
    web_rig_expect(&client, "GET", path, "", NULL, 414, "too-long");
    https_send(&client, "GET / HTTP/1.1\r\n\r\n");
    https_read(&client, &answer);
    assert_int_equal(answer.status, 400);
    https_answer_free(&answer);
    https_close(&client);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(each_check_has_its_problem),
        TEST(a_role_is_necessary_and_sufficient),
        TEST(one_account_does_not_keep_the_others_waiting),
        TEST(a_handler_learns_the_request),
        TEST(a_name_may_be_in_the_middle_of_a_path),
        TEST(a_method_that_is_missing_names_those_that_exist),
        TEST(a_body_has_a_limit),
        TEST(a_body_in_chunks_has_the_same_limit),
        TEST(requests_without_host_or_of_great_length_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
