/* The accounts by the API, and the problems of the daemon. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/enroll/web/rigs/api_rig.h"
#include "tests/support/scratch.h"

static void accounts_are_added_changed_and_removed(void **state)
{
    (void)state;
    api_rig_add_account("root", WEB_ROLE_ADMINISTRATOR);
    char *root = api_rig_log_in_as("root");
    api_rig_expect("POST", "/api/v1/accounts", root,
                   "{\"name\":\"bob\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 201,
                   NULL);
    char *bob = api_rig_log_in_as("bob");
    api_rig_expect("PATCH", "/api/v1/accounts/bob", root, "{\"role\":\"enroller\"}", 200, NULL);
    api_rig_expect("GET", "/api/v1/session", bob, NULL, 401, "login-required");
    free(bob);
    bob = api_rig_log_in_as("bob");
    api_rig_expect("PATCH", "/api/v1/accounts/bob", root, "{\"password\":\"" OTHER "\"}", 200,
                   NULL);
    api_rig_expect("GET", "/api/v1/session", bob, NULL, 401, "login-required");
    assert_true(web_password_is(OTHER, web_accounts_find(api_rig.api.login.accounts, "bob")->hash));
    assert_int_equal(web_accounts_find(api_rig.api.login.accounts, "bob")->role, WEB_ROLE_ENROLLER);
    api_rig_expect("DELETE", "/api/v1/accounts/bob", root, NULL, 204, NULL);
    assert_null(web_accounts_find(api_rig.api.login.accounts, "bob"));
    assert_string_equal(api_rig.said,
                        "root login \nroot account-add bob\nbob login \n"
                        "root account-change bob\nbob login \nroot account-change bob\n"
                        "root account-remove bob\n");
    free(bob);
    free(root);
}

static void send_request(const char *method, const char *path, const char *headers,
                         const char *body)
{
    char *text = NULL;
    assert_true(asprintf(&text,
                         "%s %s HTTP/1.1\r\nHost: door.test\r\n%sContent-Length: %zu\r\n\r\n%s",
                         method, path, headers, strlen(body), body) > 0);
    https_send(&api_rig.client, text);
    free(text);
}

/* The record of an act is answered, and nothing else happens. */
static void answer_record(void)
{
    while (!api_rig.on_reply) {
        https_pump(api_rig.web.event, -1);
    }
    (void)api_rig_reply(NULL, NULL);
}

static void expect_status(int status)
{
    struct https_answer answer;
    https_read(&api_rig.client, &answer);
    assert_int_equal(answer.status, status);
    https_answer_free(&answer);
}

/* Like the check of a login, so that the loop goes on between two hashes. */
static void a_new_password_is_hashed_in_its_turn(void **state)
{
    (void)state;
    api_rig_add_account("root", WEB_ROLE_ADMINISTRATOR);
    char *root = api_rig_log_in_as("root");
    api_rig.waits = true;
    send_request("POST", "/api/v1/accounts", root,
                 "{\"name\":\"bob\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}");
    answer_record();
    assert_null(web_accounts_find(api_rig.api.login.accounts, "bob"));
    expect_status(201);
    assert_non_null(web_accounts_find(api_rig.api.login.accounts, "bob"));

    send_request("PATCH", "/api/v1/accounts/bob", root, "{\"password\":\"" OTHER "\"}");
    answer_record();
    assert_true(
        web_password_is(PASSWORD, web_accounts_find(api_rig.api.login.accounts, "bob")->hash));
    expect_status(200);
    assert_true(web_password_is(OTHER, web_accounts_find(api_rig.api.login.accounts, "bob")->hash));

    /* The session ends between the record and the turn. */
    send_request("PATCH", "/api/v1/accounts/bob", root, "{\"password\":\"" PASSWORD "\"}");
    answer_record();
    web_session_end_account(api_rig.api.login.sessions, "root", 0);
    expect_status(401);
    assert_true(web_password_is(OTHER, web_accounts_find(api_rig.api.login.accounts, "bob")->hash));
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

    api_rig_add_account("root", WEB_ROLE_ADMINISTRATOR);
    char *root = api_rig_log_in_as("root");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        (void)snprintf(path, sizeof path, "/api/v1/accounts%s", cases[i].path);
        api_rig_expect(cases[i].method, path, root, cases[i].body, cases[i].status, cases[i].code);
    }
    assert_string_equal(api_rig.said, "root login \n");
    assert_int_equal(web_accounts_count(api_rig.api.login.accounts), 1);
    for (int i = 1; i < WEB_ACCOUNTS_MOST; i++) {
        (void)snprintf(path, sizeof path, "a%d", i);
        struct iso_fault fault;
        assert_int_equal(
            web_accounts_add(api_rig.api.login.accounts, path, PASSWORD, WEB_ROLE_OBSERVER, &fault),
            0);
    }
    api_rig_expect("POST", "/api/v1/accounts", root,
                   "{\"name\":\"bob\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 409,
                   "too-many-accounts");
    free(root);
}

static void nothing_is_changed_without_a_record(void **state)
{
    const sd_bus_error full = {.name = ISO_CONTRACT_ERROR_STORAGE, .message = "the disk is full"};
    const sd_bus_error gone = {.name = SD_BUS_ERROR_NO_REPLY};
    (void)state;

    api_rig_add_account("root", WEB_ROLE_ADMINISTRATOR);
    api_rig_add_account("bob", WEB_ROLE_OBSERVER);
    char *root = api_rig_log_in_as("root");
    api_rig.error = &full;
    api_rig_expect("DELETE", "/api/v1/accounts/bob", root, NULL, 507, "storage");
    api_rig.error = &gone;
    api_rig_expect("PATCH", "/api/v1/accounts/bob", root, "{\"role\":\"administrator\"}", 503,
                   "no-daemon");
    api_rig_expect("POST", "/api/v1/accounts", root,
                   "{\"name\":\"eve\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 503,
                   "no-daemon");
    api_rig_expect("PUT", "/api/v1/session/password", root,
                   "{\"old\":\"" PASSWORD "\",\"new\":\"" OTHER "\"}", 503, "no-daemon");
    assert_int_equal(web_accounts_count(api_rig.api.login.accounts), 2);
    assert_int_equal(web_accounts_find(api_rig.api.login.accounts, "bob")->role, WEB_ROLE_OBSERVER);
    assert_true(
        web_password_is(PASSWORD, web_accounts_find(api_rig.api.login.accounts, "root")->hash));
    free(root);
}

static void a_session_that_ends_before_the_record_changes_nothing(void **state)
{
    struct https_answer answer;
    (void)state;

    api_rig_add_account("root", WEB_ROLE_ADMINISTRATOR);
    api_rig_add_account("bob", WEB_ROLE_OBSERVER);
    char *root = api_rig_log_in_as("root"), *request = NULL;
    api_rig.waits = true;
    assert_true(asprintf(&request,
                         "DELETE /api/v1/accounts/bob HTTP/1.1\r\nHost: door.test\r\n%s\r\n",
                         root) > 0);
    https_send(&api_rig.client, request);
    for (int i = 0; !api_rig.on_reply; i++) {
        assert_true(i < 1000);
        https_pump(api_rig.web.event, api_rig.client.fd);
    }
    web_session_end_account(&api_rig.web.sessions, "root", 0);
    (void)api_rig_reply(NULL, NULL);
    https_read(&api_rig.client, &answer);
    assert_int_equal(answer.status, 401);
    https_answer_free(&answer);
    assert_non_null(web_accounts_find(api_rig.api.login.accounts, "bob"));
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

    api_rig_add_account("root", WEB_ROLE_ADMINISTRATOR);
    api_rig_add_account("bob", WEB_ROLE_OBSERVER);
    char *root = api_rig_log_in_as("root");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const sd_bus_error error = {.name = cases[i].name, .message = "words of the daemon"};
        api_rig.error = &error;
        api_rig.said[0] = '\0';
        api_rig_expect("DELETE", "/api/v1/accounts/bob", root, NULL, cases[i].status,
                       cases[i].code);
    }
    free(root);
}

static void a_disk_that_refuses_is_a_problem(void **state)
{
    (void)state;
    api_rig_add_account("root", WEB_ROLE_ADMINISTRATOR);
    char *root = api_rig_log_in_as("root");
    /* The draft of the file cannot be made where a folder has its name. */
    scratch_mkdir(scratch_path(*state, "accounts.json.new"));
    api_rig_expect("POST", "/api/v1/accounts", root,
                   "{\"name\":\"bob\",\"password\":\"" PASSWORD "\",\"role\":\"observer\"}", 507,
                   "storage");
    assert_int_equal(web_accounts_count(api_rig.api.login.accounts), 1);
    free(root);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, api_rig_setup, api_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(accounts_are_added_changed_and_removed),
        TEST(a_new_password_is_hashed_in_its_turn),
        TEST(wrong_changes_of_accounts_are_refused),
        TEST(nothing_is_changed_without_a_record),
        TEST(a_session_that_ends_before_the_record_changes_nothing),
        TEST(errors_of_the_daemon_become_problems),
        TEST(a_disk_that_refuses_is_a_problem),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
