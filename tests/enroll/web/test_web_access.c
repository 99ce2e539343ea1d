/* The handlers of cards and of the policy: what they ask of the daemon, in which order, and what
 * they answer. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/access/access.h"
#include "firmware/contract/contract.h"
#include "tests/enroll/web/rigs/access_rig.h"
#include "tests/enroll/web/rigs/handler_rig.h"

typedef void handler(void *api, struct web_exchange *exchange);

#define CREDENTIAL                                                                          \
    "{\"enabled\":false,\"disabled_reason\":\"lost\",\"cards\":[\"17/4711\"],\"pin\":true," \
    "\"duress_pin\":false,\"profiles\":[]}"

static struct rig_access access_rig;

static int setup(void **state)
{
    const int r = rig_setup(state);
    struct rig *rig = *state;
    access_rig = (struct rig_access){.outcome = "allow", .credential = CREDENTIAL};
    if (rig) {
        rig_access_serve(&access_rig, &rig->service);
    }
    return r;
}

/* Makes a request, expects this answer and these calls of the daemon. Returns the JSON of the
 * answer, which the caller releases; NULL for a problem. */
static json_t *ask(struct rig *rig, handler *handle, struct web_exchange *exchange, unsigned status,
                   const char *code, const char *calls)
{
    rig->service.trace[0] = '\0';
    handle(&rig->api, exchange);
    rig_expect(rig->event, exchange, status, code);
    assert_string_equal(rig->service.trace, calls);
    json_t *json = code ? NULL : json_incref(exchange->json);
    rig_exchange_done(exchange);
    return json;
}

static json_t *ask_of(struct rig *rig, handler *handle, const char *part, const char *body,
                      unsigned status, const char *code, const char *calls)
{
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, RIG_SESSION, body);
    exchange.part = part;
    return ask(rig, handle, &exchange, status, code, calls);
}

static void expect_problem(struct rig *rig, handler *handle, const char *part, const char *body,
                           unsigned status, const char *code, const char *calls)
{
    assert_null(ask_of(rig, handle, part, body, status, code, calls));
}

/* Expects a JSON text with ' in the place of ", and releases the JSON. */
static void expect_json(json_t *json, const char *text)
{
    char *copy = strdup(text);
    assert_non_null(copy);
    for (char *c = copy; *c; c++) {
        *c = *c == '\'' ? '"' : *c;
    }
    json_t *wanted = json_loads(copy, 0, NULL);
    assert_non_null(wanted);
    if (!json_equal(json, wanted)) {
        char *found = json_dumps(json, 0);
        fail_msg("%s, and not %s", found, copy);
        free(found);
    }
    json_decref(wanted);
    json_decref(json);
    free(copy);
}

static void fail_with(struct rig *rig, const char *method, const char *error)
{
    rig->service.fail_method = method;
    rig->service.fail_error = error;
}

/* ---- credentials ---- */

static void a_credential_is_that_of_the_daemon(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    json_t *credential = ask_of(rig, web_api_get_credential, "bo", NULL, 200, NULL,
                                "GetCredential bo;");
    assert_string_equal(json_string_value(json_array_get(json_object_get(credential, "cards"), 0)),
                        "17/4711");
    assert_true(json_is_true(json_object_get(credential, "pin")));
    json_decref(credential);
    fail_with(rig, ISO_CONTRACT_GET_CREDENTIAL, ISO_CONTRACT_ERROR_NO_SUCH_PERSON);
    expect_problem(rig, web_api_get_credential, "bo", NULL, 404, "no-such-person",
                   "GetCredential bo;");
}

static void a_credential_is_changed_after_the_record(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    json_decref(ask_of(rig, web_api_change_credential, "bo", "{'cards': ['17/4711'], 'pin': null}",
                       200, NULL,
                       "RecordAct ada credential bo;"
                       "SetCredential bo {\"cards\":[\"17/4711\"],\"pin\":null};"));
    /* RecordAct refuses the names of earlier versions; the daemon's own record has them. */
    json_decref(ask_of(rig, web_api_change_credential, " bo", "{'enabled': false}", 200, NULL,
                       "RecordAct ada credential ;SetCredential  bo {\"enabled\":false};"));
    expect_problem(rig, web_api_change_credential, "bo", "{}", 400, "invalid-member", "");
    fail_with(rig, ISO_CONTRACT_RECORD_ACT, ISO_CONTRACT_ERROR_STORAGE);
    expect_problem(rig, web_api_change_credential, "bo", "{'pin': '1234'}", 507, "storage",
                   "RecordAct ada credential bo;");
}

static void the_daemon_refuses_a_credential(void **state)
{
    static const struct {
        const char *error;
        unsigned status;
        const char *code;
    } refusals[] = {
        {ISO_CONTRACT_ERROR_INVALID_ARGUMENT, 400, "invalid-credential"},
        {ISO_CONTRACT_ERROR_NAME_IN_USE, 409, "card-in-use"},
        {ISO_CONTRACT_ERROR_NO_SUCH_PERSON, 404, "no-such-person"},
        {ISO_CONTRACT_ERROR_STORAGE, 507, "storage"},
    };
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
        fail_with(rig, ISO_CONTRACT_SET_CREDENTIAL, refusals[i].error);
        expect_problem(rig, web_api_change_credential, "bo", "{'pin': '1'}", refusals[i].status,
                       refusals[i].code,
                       "RecordAct ada credential bo;SetCredential bo {\"pin\":\"1\"};");
    }
}

static void nothing_changes_for_a_session_that_has_ended_meanwhile(void **state)
{
    static const struct {
        handler *handle;
        const char *body, *calls;
    } changes[] = {
        {web_api_change_credential, "{'enabled': false}", "RecordAct ada credential bo;"},
        {web_api_set_policy, "{'revision': 1, 'document': {}}", "RecordAct ada policy ;"},
    };
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, rig_session(rig),
                                                    changes[i].body);
        exchange.part = "bo";
        rig->service.trace[0] = '\0';
        changes[i].handle(&rig->api, &exchange);
        web_session_end(&rig->sessions, exchange.session);
        rig_expect(rig->event, &exchange, 401, "login-required");
        rig_run(rig->event, 100);
        assert_string_equal(rig->service.trace, changes[i].calls);
        rig_exchange_done(&exchange);
    }
}

static void administrators_see_cards_in_the_list(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.n_people = 2;
    access_rig.holder = "person 00001";
    json_t *list = ask_of(rig, web_api_list_people, NULL, NULL, 200, NULL, "ListCredentials;");
    const json_t *people = json_object_get(list, "people");
    assert_int_equal(json_array_size(json_object_get(json_array_get(people, 0), "cards")), 0);
    assert_true(json_is_true(json_object_get(json_array_get(people, 0), "enabled")));
    const json_t *second = json_array_get(people, 1);
    assert_string_equal(json_string_value(json_array_get(json_object_get(second, "cards"), 0)),
                        "17/4711");
    assert_true(json_is_false(json_object_get(second, "enabled")));
    json_decref(list);

    struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, RIG_SESSION, NULL);
    list = ask(rig, web_api_list_people, &exchange, 200, NULL, "");
    people = json_object_get(list, "people");
    assert_int_equal(json_array_size(people), 2);
    assert_null(json_object_get(json_array_get(people, 1), "cards"));
    json_decref(list);

    access_rig.credential = "no JSON";
    expect_problem(rig, web_api_list_people, NULL, NULL, 500, NULL, "ListCredentials;");
    fail_with(rig, ISO_CONTRACT_LIST_CREDENTIALS, ISO_CONTRACT_ERROR_STORAGE);
    expect_problem(rig, web_api_list_people, NULL, NULL, 507, "storage", "ListCredentials;");
}

/* ---- the policy ---- */

static void a_policy_is_read(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    expect_json(ask_of(rig, web_api_get_policy, NULL, NULL, 200, NULL, "GetPolicy;"),
                "{'revision': 0, 'document': null}");
    access_rig.document = "{\"areas\":[{\"token\":\"hall\"}]}";
    access_rig.revision = 7;
    expect_json(ask_of(rig, web_api_get_policy, NULL, NULL, 200, NULL, "GetPolicy;"),
                "{'revision': 7, 'document': {'areas': [{'token': 'hall'}]}}");
    access_rig.finding = "Nobody has the profile \"staff\".";
    json_t *answer = ask_of(rig, web_api_get_findings, NULL, NULL, 200, NULL, "CheckPolicy;");
    assert_string_equal(json_string_value(json_array_get(json_object_get(answer, "findings"), 0)),
                        access_rig.finding);
    json_decref(answer);
}

static void a_policy_is_stored_after_the_record(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    access_rig.revision = 3;
    access_rig.finding = "a finding";
    expect_json(ask_of(rig, web_api_set_policy, NULL,
                       "{'revision': 3, 'document': {'areas': [{'token': 'hall'}]}}", 200, NULL,
                       "RecordAct ada policy ;SetPolicy {\"areas\":[{\"token\":\"hall\"}]} 3;"),
                "{'revision': 4, 'remarks': ['a finding']}");
    access_rig.finding = NULL;
    expect_json(ask_of(rig, web_api_set_policy, NULL, "{'revision': 3, 'document': null}", 200,
                       NULL, "RecordAct ada policy-remove ;SetPolicy  3;"),
                "{'revision': 4, 'remarks': []}");
    fail_with(rig, ISO_CONTRACT_RECORD_ACT, ISO_CONTRACT_ERROR_STORAGE);
    expect_problem(rig, web_api_set_policy, NULL, "{'revision': 3, 'document': null}", 507,
                   "storage", "RecordAct ada policy-remove ;");
}

static void a_wrong_policy_is_refused(void **state)
{
    static const char *const wrong[] = {
        "{}",
        "{'revision': 1}",
        "{'document': {}}",
        "{'revision': -1, 'document': {}}",
        "{'revision': '1', 'document': {}}",
        "{'revision': 1, 'document': []}",
        "{'revision': 1, 'document': '{}'}",
    };
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        expect_problem(rig, web_api_set_policy, NULL, wrong[i], 400, "invalid-member", "");
    }
    fail_with(rig, ISO_CONTRACT_SET_POLICY, ISO_CONTRACT_ERROR_CONFLICT);
    expect_problem(rig, web_api_set_policy, NULL, "{'revision': 1, 'document': {}}", 409,
                   "policy-changed", "RecordAct ada policy ;SetPolicy {} 1;");
    fail_with(rig, ISO_CONTRACT_SET_POLICY, ISO_CONTRACT_ERROR_INVALID_ARGUMENT);
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, RIG_SESSION,
                                                "{'revision': 1, 'document': {}}");
    web_api_set_policy(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 400, "invalid-policy");
    assert_string_equal(exchange.detail, "as the script says");
    rig_exchange_done(&exchange);
}

/* Asks with parameters: names and values in turn. */
static json_t *test_with(struct rig *rig, const char *const query[8], unsigned status,
                         const char *code, const char *calls)
{
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, RIG_SESSION, NULL);
    memcpy(exchange.query, query, sizeof exchange.query);
    return ask(rig, web_api_test_access, &exchange, status, code, calls);
}

static void a_decision_is_asked_for(void **state)
{
    const char *all[8] = {"person", "bo", "time", "1795608000", "shown", "pin,face"};
    const char *point[8] = {"person", "bo", "time", "5", "access_point", "front"};
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    access_rig.outcome = "want";
    access_rig.wanted = "card";
    access_rig.companion = true;
    expect_json(test_with(rig, all, 200, NULL, "TestAccess bo  1795608000 +face +pin;"),
                "{'outcome': 'want', 'reason': '', 'wanted': ['card'], 'companion': true, 'level': "
                "'face', 'access_point': 'front'}");
    access_rig = (struct rig_access){
        .service = &rig->service, .outcome = "deny", .reason = "NotPermittedAtThisTime"};
    expect_json(test_with(rig, point, 200, NULL, "TestAccess bo front 5;"),
                "{'outcome': 'deny', 'reason': 'NotPermittedAtThisTime', 'wanted': [], "
                "'companion': false, 'level': 'face', 'access_point': 'front'}");
}

static void a_wrong_question_is_refused(void **state)
{
    static const char *const wrong[][8] = {
        {"shown", "face"},
        {"person", ""},
        {"person", "bo", "shown", "face,nose"},
        {"person", "bo", "shown", "face,face"},
        {"person", "bo", "shown", "face,"},
        {"person", "bo", "time", "noon"},
        {"person", "bo", "time", "-1"},
    };
    const char *right[8] = {"person", "bo", "time", "5"};
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_null(test_with(rig, wrong[i], 400, "invalid-parameter", ""));
    }
    fail_with(rig, ISO_CONTRACT_TEST_ACCESS, ISO_CONTRACT_ERROR_INVALID_ARGUMENT);
    assert_null(test_with(rig, right, 400, "invalid-parameter", "TestAccess bo  5;"));
    fail_with(rig, ISO_CONTRACT_TEST_ACCESS, ISO_CONTRACT_ERROR_NO_SUCH_PERSON);
    assert_null(test_with(rig, right, 404, "no-such-person", "TestAccess bo  5;"));
}

static void every_request_is_answered_while_the_daemon_is_gone(void **state)
{
    static const struct {
        handler *handle;
        const char *body;
    } requests[] = {
        {web_api_get_credential, NULL}, {web_api_change_credential, "{'enabled': true}"},
        {web_api_get_policy, NULL},     {web_api_set_policy, "{'revision': 0, 'document': {}}"},
        {web_api_get_findings, NULL},
    };
    const char *query[8] = {"person", "bo"};
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig_service_stop(&rig->service);
    rig_wait_daemon(rig, false);
    for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
        expect_problem(rig, requests[i].handle, "bo", requests[i].body, 503, "no-daemon", "");
    }
    assert_null(test_with(rig, query, 503, "no-daemon", ""));
}

#define ACCESS_TEST(name) cmocka_unit_test_setup_teardown(name, setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ACCESS_TEST(a_credential_is_that_of_the_daemon),
        ACCESS_TEST(a_credential_is_changed_after_the_record),
        ACCESS_TEST(the_daemon_refuses_a_credential),
        ACCESS_TEST(nothing_changes_for_a_session_that_has_ended_meanwhile),
        ACCESS_TEST(administrators_see_cards_in_the_list),
        ACCESS_TEST(a_policy_is_read),
        ACCESS_TEST(a_policy_is_stored_after_the_record),
        ACCESS_TEST(a_wrong_policy_is_refused),
        ACCESS_TEST(a_decision_is_asked_for),
        ACCESS_TEST(a_wrong_question_is_refused),
        ACCESS_TEST(every_request_is_answered_while_the_daemon_is_gone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
