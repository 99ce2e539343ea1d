/* Login, setup and accounts by the API. The connection to the daemon is a stand-in that keeps what
 * was to be put on record. */
#include <jansson.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/account/setup_code.h"
#include "enroll/web/api/api.h"
#include "firmware/contract/contract.h"
#include "tests/enroll/web/rigs/web_rig.h"
#include "tests/support/scratch.h"

#define PASSWORD "correct horse battery"
#define OTHER    "another long password"

static struct web_rig rig;
static struct web_api api;
static struct web_guess guess;
static struct https client;
static char setup_code[256], accounts_path[256];

/* ---- the stand-in for the daemon ---- */

static struct {
    char said[1024];           /* "account act person\n" for each record */
    const sd_bus_error *error; /* of the records; NULL: they succeed */
    bool waits;                /* the next answer comes when the test wants it */
    web_daemon_reply_fn on_reply;
    void *context;
} bus;

static int reply(sd_event_source *source, void *context)
{
    web_daemon_reply_fn on_reply = bus.on_reply;
    (void)context;

    bus.on_reply = NULL;
    on_reply(bus.context, NULL, bus.error);
    sd_event_source_unref(source);
    return 0;
}

void web_daemon_record(struct web_daemon *daemon, const char *account, const char *act,
                       const char *person, web_daemon_reply_fn on_reply, void *context)
{
    const size_t n = strlen(bus.said);
    sd_event_source *source = NULL;
    (void)daemon;

    (void)snprintf(bus.said + n, sizeof bus.said - n, "%s %s %s\n", account, act, person);
    assert_null(bus.on_reply);
    bus.on_reply = on_reply;
    bus.context = context;
    if (!bus.waits) {
        assert_true(sd_event_add_defer(rig.event, &source, reply, NULL) >= 0);
    }
}

static const struct web_route routes[] = {
    {"GET", "/openapi.json", WEB_ROLE_NONE, web_api_get_document},
    {"GET", "/session", WEB_ROLE_NONE, web_api_get_session},
    {"POST", "/session", WEB_ROLE_NONE, web_api_login},
    {"DELETE", "/session", WEB_ROLE_NONE, web_api_logout},
    {"PUT", "/session/password", WEB_ROLE_OBSERVER, web_api_set_own_password},
    {"POST", "/setup", WEB_ROLE_NONE, web_api_setup},
    {"GET", "/accounts", WEB_ROLE_ADMINISTRATOR, web_api_list_accounts},
    {"POST", "/accounts", WEB_ROLE_ADMINISTRATOR, web_api_add_account},
    {"PATCH", "/accounts/{name}", WEB_ROLE_ADMINISTRATOR, web_api_change_account},
    {"DELETE", "/accounts/{name}", WEB_ROLE_ADMINISTRATOR, web_api_remove_account},
    {NULL, NULL, WEB_ROLE_NONE, NULL},
};

static int setup(void **state)
{
    struct iso_fault fault = {.text = ""};

    assert_int_equal(scratch_setup(state), 0);
    memset(&bus, 0, sizeof bus);
    memset(&api, 0, sizeof api);
    web_rig_start(&rig, *state, routes, &api);
    web_guess_init(&guess);
    (void)snprintf(setup_code, sizeof setup_code, "%s/setup.code", (const char *)*state);
    (void)snprintf(accounts_path, sizeof accounts_path, "%s/accounts.json", (const char *)*state);
    assert_int_equal(web_accounts_open(accounts_path, &api.accounts, &fault), 0);
    api.sessions = &rig.sessions;
    api.guess = &guess;
    api.setup_code = setup_code;
    api.document = "{\"openapi\": \"3.1.0\"}";
    api.server = rig.server;
    web_rig_connect(&rig, &client);
    return 0;
}

static int teardown(void **state)
{
    https_close(&client);
    web_rig_stop(&rig);
    web_accounts_close(api.accounts);
    return scratch_teardown(state);
}

static void add_account(const char *name, enum web_role role)
{
    struct iso_fault fault = {.text = ""};

    assert_int_equal(web_accounts_add(api.accounts, name, PASSWORD, role, &fault), 0);
}

/* Asks, and returns the header lines of further requests with the cookie of the answer in a new
 * text. */
static char *log_in(const char *path, const char *body)
{
    struct https_answer answer;
    char *headers = NULL;

    https_ask(&client, "POST", path, WEB_RIG_ORIGIN WEB_RIG_JSON, body, &answer);
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

static char *log_in_as(const char *name)
{
    char body[256];

    (void)snprintf(body, sizeof body, "{\"account\":\"%s\",\"password\":\"" PASSWORD "\"}", name);
    return log_in("/api/v1/session", body);
}

static void expect(const char *method, const char *path, const char *headers, const char *body,
                   int status, const char *code)
{
    web_rig_expect(&client, method, path, headers, body, status, code);
}

static void expect_body(const char *method, const char *path, const char *headers, int status,
                        const char *body)
{
    struct https_answer answer;

    https_ask(&client, method, path, headers, NULL, &answer);
    assert_int_equal(answer.status, status);
    assert_string_equal(answer.body, body);
    https_answer_free(&answer);
}

/* Whether the problem of GET /session says that there is no account yet. */
static bool says_setup(void)
{
    struct https_answer answer;

    https_ask(&client, "GET", "/api/v1/session", "", NULL, &answer);
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
    add_account("ada", WEB_ROLE_ENROLLER);
    assert_false(says_setup());
    char *headers = log_in_as("ada");
    expect_body("GET", "/api/v1/session", headers, 200,
                "{\"account\":\"ada\",\"role\":\"enroller\"}");
    expect("GET", "/api/v1/accounts", headers, NULL, 403, "not-allowed");
    expect("DELETE", "/api/v1/session", headers, NULL, 204, NULL);
    expect("GET", "/api/v1/session", headers, NULL, 401, "login-required");
    expect("DELETE", "/api/v1/session", headers, NULL, 204, NULL);
    expect("DELETE", "/api/v1/session", "", NULL, 403, "other-origin");
    assert_string_equal(bus.said, "ada login \nada logout \n");
    free(headers);
}

static void a_new_login_ends_the_session_before(void **state)
{
    struct https_answer answer;
    (void)state;

    add_account("ada", WEB_ROLE_ENROLLER);
    char *headers = log_in_as("ada");
    https_ask(&client, "POST", "/api/v1/session", headers,
              "{\"account\":\"ada\",\"password\":\"" PASSWORD "\"}", &answer);
    assert_int_equal(answer.status, 201);
    https_answer_free(&answer);
    expect("GET", "/api/v1/session", headers, NULL, 401, "login-required");
    free(headers);
}

static void a_login_works_without_the_daemon(void **state)
{
    const sd_bus_error gone = {.name = SD_BUS_ERROR_SERVICE_UNKNOWN, .message = "gone"};
    (void)state;

    add_account("ada", WEB_ROLE_OBSERVER);
    bus.error = &gone;
    char *headers = log_in_as("ada");
    expect("GET", "/api/v1/session", headers, NULL, 200, NULL);
    free(headers);
}

static double seconds_of(const char *body)
{
    struct timespec begin, end;

    (void)clock_gettime(CLOCK_MONOTONIC, &begin);
    expect("POST", "/api/v1/session", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 401, "wrong-password");
    (void)clock_gettime(CLOCK_MONOTONIC, &end);
    return (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
}

static void a_wrong_password_is_refused_and_slowed_down(void **state)
{
    static const char wrong[] = "{\"account\":\"ada\",\"password\":\"wrong\"}";
    static const char unknown[] = "{\"account\":\"nobody\",\"password\":\"wrong\"}";
    struct https_answer answer;
    (void)state;

    add_account("ada", WEB_ROLE_OBSERVER);
    const double known_s = seconds_of(wrong), unknown_s = seconds_of(unknown);
    assert_true(unknown_s > 0.3 * known_s);
    (void)seconds_of(wrong);
    https_ask(&client, "POST", "/api/v1/session", WEB_RIG_ORIGIN WEB_RIG_JSON,
              "{\"account\":\"ada\",\"password\":\"" PASSWORD "\"}", &answer);
    assert_int_equal(answer.status, 429);
    assert_string_equal(https_header(&answer, "Retry-After"), "1");
    https_answer_free(&answer);
    assert_string_equal(bus.said, "");
}

static void members_of_a_login_are_checked(void **state)
{
    static const char *const bodies[] = {
        "{}", "{\"account\":\"ada\"}", "{\"account\":1,\"password\":\"x\"}",
        "{\"account\":\"\",\"password\":\"x\"}",
        "{\"account\":\"abcdefghijklmnopqrstuvwxyz0123456\",\"password\":\"x\"}"};
    (void)state;

    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
        expect("POST", "/api/v1/session", WEB_RIG_ORIGIN WEB_RIG_JSON, bodies[i], 400,
               "invalid-member");
    }
    expect("POST", "/api/v1/session", WEB_RIG_ORIGIN, NULL, 400, "invalid-member");
}

static void the_code_makes_one_administrator(void **state)
{
    char code[WEB_SETUP_CODE_SIZE], body[512];
    struct iso_fault fault = {.text = ""};
    (void)state;

    assert_int_equal(web_setup_code_make(setup_code, time(NULL), code, &fault), 0);
    expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON,
           "{\"code\":\"00000-00000-00000-00000\",\"account\":\"ada\",\"password\":\"" PASSWORD
           "\"}",
           401, "wrong-code");
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"Ada\",\"password\":\"%s\"}",
                   code, PASSWORD);
    expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 400, "invalid-account");
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"ada\",\"password\":\"%s\"}",
                   code, "short");
    expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 400, "invalid-password");
    add_account("ada", WEB_ROLE_OBSERVER);
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"ada\",\"password\":\"%s\"}",
                   code, PASSWORD);
    expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 409, "account-exists");
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"bob\",\"password\":\"%s\"}",
                   code, PASSWORD);
    char *headers = log_in("/api/v1/setup", body);
    expect_body("GET", "/api/v1/accounts", headers, 200,
                "{\"accounts\":[{\"name\":\"ada\",\"role\":\"observer\"},"
                "{\"name\":\"bob\",\"role\":\"administrator\"}]}");
    assert_string_equal(bus.said, "bob setup \n");
    (void)snprintf(body, sizeof body, "{\"code\":\"%s\",\"account\":\"eve\",\"password\":\"%s\"}",
                   code, PASSWORD);
    expect("POST", "/api/v1/setup", WEB_RIG_ORIGIN WEB_RIG_JSON, body, 401, "wrong-code");
    free(headers);
}

static void an_own_password_is_changed(void **state)
{
    (void)state;
    add_account("ada", WEB_ROLE_OBSERVER);
    char *own = log_in_as("ada"), *elsewhere = log_in_as("ada");
    const char *path = "/api/v1/session/password";
    expect("PUT", path, own, "{\"old\":\"wrong\",\"new\":\"" OTHER "\"}", 401, "wrong-password");
    expect("PUT", path, own, "{\"old\":\"" PASSWORD "\",\"new\":\"short\"}", 400,
           "invalid-password");
    expect("PUT", path, own, "{\"old\":\"" PASSWORD "\",\"new\":\"" OTHER "\"}", 204, NULL);
    expect("GET", "/api/v1/session", own, NULL, 200, NULL);
    expect("GET", "/api/v1/session", elsewhere, NULL, 401, "login-required");
    assert_true(web_password_is(OTHER, web_accounts_find(api.accounts, "ada")->hash));
    assert_string_equal(bus.said, "ada login \nada login \nada password-change \n");
    free(own);
    free(elsewhere);
}

static void accounts_are_added_changed_and_removed(void **state)
{
    (void)state;
    add_account("root", WEB_ROLE_ADMINISTRATOR);
    char *root = log_in_as("root");
    expect("POST", "/api/v1/accounts", root,
           "{\"name\":\"bob\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 201, NULL);
    char *bob = log_in_as("bob");
    expect("PATCH", "/api/v1/accounts/bob", root, "{\"role\":\"enroller\"}", 200, NULL);
    expect("GET", "/api/v1/session", bob, NULL, 401, "login-required");
    free(bob);
    bob = log_in_as("bob");
    expect("PATCH", "/api/v1/accounts/bob", root, "{\"password\":\"" OTHER "\"}", 200, NULL);
    expect("GET", "/api/v1/session", bob, NULL, 401, "login-required");
    assert_true(web_password_is(OTHER, web_accounts_find(api.accounts, "bob")->hash));
    assert_int_equal(web_accounts_find(api.accounts, "bob")->role, WEB_ROLE_ENROLLER);
    expect("DELETE", "/api/v1/accounts/bob", root, NULL, 204, NULL);
    assert_null(web_accounts_find(api.accounts, "bob"));
    assert_string_equal(bus.said, "root login \nroot account-add bob\nbob login \n"
                                  "root account-change bob\nbob login \nroot account-change bob\n"
                                  "root account-remove bob\n");
    free(bob);
    free(root);
}

static void wrong_changes_of_accounts_are_refused(void **state)
{
    static const struct {
        const char *method, *path, *body;
        int status;
        const char *code;
    } cases[] = {
        {"POST", "", "{\"name\":\"B\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 400,
         "invalid-account"},
        {"POST", "", "{\"name\":\"bob\",\"password\":\"short\",\"role\":\"observer\"}", 400,
         "invalid-password"},
        {"POST", "", "{\"name\":\"bob\",\"password\":\"" PASSWORD "\",\"role\":\"none\"}", 400,
         "invalid-role"},
        {"POST", "", "{\"name\":\"bob\",\"password\":\"" PASSWORD "\"}", 400, "invalid-member"},
        {"POST", "", "{\"name\":\"root\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 409,
         "account-exists"},
        {"PATCH", "/bob", "{\"role\":\"observer\"}", 404, "no-such-account"},
        {"PATCH", "/root", "{\"role\":\"observer\"}", 409, "last-administrator"},
        {"PATCH", "/root", "{\"role\":\"chief\"}", 400, "invalid-role"},
        {"PATCH", "/root", "{\"role\":3}", 400, "invalid-member"},
        {"PATCH", "/root", "{\"password\":\"short\"}", 400, "invalid-password"},
        {"PATCH", "/root", "{}", 400, "invalid-member"},
        {"DELETE", "/bob", NULL, 404, "no-such-account"},
        {"DELETE", "/root", NULL, 409, "last-administrator"},
    };
    char path[64];
    (void)state;

    add_account("root", WEB_ROLE_ADMINISTRATOR);
    char *root = log_in_as("root");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        (void)snprintf(path, sizeof path, "/api/v1/accounts%s", cases[i].path);
        expect(cases[i].method, path, root, cases[i].body, cases[i].status, cases[i].code);
    }
    assert_string_equal(bus.said, "root login \n");
    assert_int_equal(web_accounts_count(api.accounts), 1);
    for (int i = 1; i < WEB_ACCOUNTS_MOST; i++) {
        (void)snprintf(path, sizeof path, "a%d", i);
        struct iso_fault fault;
        assert_int_equal(web_accounts_add(api.accounts, path, PASSWORD, WEB_ROLE_OBSERVER, &fault),
                         0);
    }
    expect("POST", "/api/v1/accounts", root,
           "{\"name\":\"bob\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 409,
           "too-many-accounts");
    free(root);
}

static void nothing_is_changed_without_a_record(void **state)
{
    const sd_bus_error full = {.name = ISO_CONTRACT_ERROR_STORAGE, .message = "the disk is full"};
    const sd_bus_error gone = {.name = SD_BUS_ERROR_NO_REPLY};
    (void)state;

    add_account("root", WEB_ROLE_ADMINISTRATOR);
    add_account("bob", WEB_ROLE_OBSERVER);
    char *root = log_in_as("root");
    bus.error = &full;
    expect("DELETE", "/api/v1/accounts/bob", root, NULL, 507, "storage");
    bus.error = &gone;
    expect("PATCH", "/api/v1/accounts/bob", root, "{\"role\":\"administrator\"}", 503, "no-daemon");
    expect("POST", "/api/v1/accounts", root,
           "{\"name\":\"eve\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 503,
           "no-daemon");
    expect("PUT", "/api/v1/session/password", root,
           "{\"old\":\"" PASSWORD "\",\"new\":\"" OTHER "\"}", 503, "no-daemon");
    assert_int_equal(web_accounts_count(api.accounts), 2);
    assert_int_equal(web_accounts_find(api.accounts, "bob")->role, WEB_ROLE_OBSERVER);
    assert_true(web_password_is(PASSWORD, web_accounts_find(api.accounts, "root")->hash));
    free(root);
}

static void a_session_that_ends_before_the_record_changes_nothing(void **state)
{
    struct https_answer answer;
    (void)state;

    add_account("root", WEB_ROLE_ADMINISTRATOR);
    add_account("bob", WEB_ROLE_OBSERVER);
    char *root = log_in_as("root"), *request = NULL;
    bus.waits = true;
    assert_true(asprintf(&request,
                         "DELETE /api/v1/accounts/bob HTTP/1.1\r\nHost: door.test\r\n%s\r\n",
                         root) > 0);
    https_send(&client, request);
    for (int i = 0; !bus.on_reply; i++) {
        assert_true(i < 1000);
        https_pump(rig.event, client.fd);
    }
    web_session_end_account(&rig.sessions, "root", 0);
    (void)reply(NULL, NULL);
    https_read(&client, &answer);
    assert_int_equal(answer.status, 401);
    https_answer_free(&answer);
    assert_non_null(web_accounts_find(api.accounts, "bob"));
    free(request);
    free(root);
}

/* Every error of the contract has a problem of its own; the rest is internal. */
static void errors_of_the_daemon_become_problems(void **state)
{
    static const struct {
        const char *name;
        int status;
        const char *code;
    } cases[] = {
        {ISO_CONTRACT_ERROR_ALREADY_IN_USE, 409, "camera-in-use"},
        {ISO_CONTRACT_ERROR_CLAIM_DEVICE, 409, "no-enrolment"},
        {ISO_CONTRACT_ERROR_NO_SUCH_PERSON, 404, "no-such-person"},
        {ISO_CONTRACT_ERROR_NO_ACTION, 409, "no-enrolment"},
        {ISO_CONTRACT_ERROR_ACTION, 409, "enrolment-running"},
        {ISO_CONTRACT_ERROR_INVALID_NAME, 400, "invalid-name"},
        {ISO_CONTRACT_ERROR_NAME_IN_USE, 409, "name-in-use"},
        {ISO_CONTRACT_ERROR_INVALID_ARGUMENT, 400, "invalid-limits"},
        {ISO_CONTRACT_ERROR_GALLERY_FULL, 409, "gallery-full"},
        {ISO_CONTRACT_ERROR_REJECTED, 409, "rejected"},
        {ISO_CONTRACT_ERROR_LOCKED_OUT, 423, "locked-out"},
        {ISO_CONTRACT_ERROR_TOO_MANY_CALLS, 503, "daemon-busy"},
        {ISO_CONTRACT_ERROR_DEVICE_FAULT, 503, "device-fault"},
        {ISO_CONTRACT_ERROR_STORAGE, 507, "storage"},
        {ISO_CONTRACT_ERROR_INTERNAL, 500, "internal"},
        {SD_BUS_ERROR_ACCESS_DENIED, 503, "daemon-denied"},
        {SD_BUS_ERROR_SERVICE_UNKNOWN, 503, "no-daemon"},
        {SD_BUS_ERROR_DISCONNECTED, 503, "no-daemon"},
        {"System.Error.ECONNRESET", 503, "no-daemon"},
        {"org.example.Error.Strange", 500, "internal"},
    };
    (void)state;

    add_account("root", WEB_ROLE_ADMINISTRATOR);
    add_account("bob", WEB_ROLE_OBSERVER);
    char *root = log_in_as("root");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const sd_bus_error error = {.name = cases[i].name, .message = "words of the daemon"};
        bus.error = &error;
        bus.said[0] = '\0';
        expect("DELETE", "/api/v1/accounts/bob", root, NULL, cases[i].status, cases[i].code);
    }
    free(root);
}

static void a_disk_that_refuses_is_a_problem(void **state)
{
    (void)state;
    add_account("root", WEB_ROLE_ADMINISTRATOR);
    char *root = log_in_as("root");
    /* The draft of the file cannot be made where a folder has its name. */
    scratch_mkdir(scratch_path(*state, "accounts.json.new"));
    expect("POST", "/api/v1/accounts", root,
           "{\"name\":\"bob\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 507,
           "storage");
    assert_int_equal(web_accounts_count(api.accounts), 1);
    free(root);
}

static void the_document_is_served(void **state)
{
    (void)state;
    expect_body("GET", "/api/v1/openapi.json", "", 200, "{\"openapi\":\"3.1.0\"}");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_person_logs_in_and_out),
        TEST(a_new_login_ends_the_session_before),
        TEST(a_login_works_without_the_daemon),
        TEST(a_wrong_password_is_refused_and_slowed_down),
        TEST(members_of_a_login_are_checked),
        TEST(the_code_makes_one_administrator),
        TEST(an_own_password_is_changed),
        TEST(accounts_are_added_changed_and_removed),
        TEST(wrong_changes_of_accounts_are_refused),
        TEST(nothing_is_changed_without_a_record),
        TEST(a_session_that_ends_before_the_record_changes_nothing),
        TEST(errors_of_the_daemon_become_problems),
        TEST(a_disk_that_refuses_is_a_problem),
        TEST(the_document_is_served),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
