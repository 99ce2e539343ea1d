/* The handlers of the door and the people: what they ask of the daemon, in which order,
 * and what they answer. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/web/rigs/handler_rig.h"

typedef void handler(void *api, struct web_exchange *exchange);

/* Makes a request, expects this answer, and expects the daemon to have had these calls. */
static void expect(struct rig *rig, handler *handle, const char *part, const char *body,
                   unsigned status, const char *code, const char *calls)
{
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, RIG_SESSION, body);
    exchange.part = part;
    rig->service.trace[0] = '\0';
    handle(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, status, code);
    assert_string_equal(rig->service.trace, calls);
    rig_exchange_done(&exchange);
}

static void fail_with(struct rig *rig, const char *method, const char *error)
{
    rig->service.fail_method = method;
    rig->service.fail_error = error;
}

/* ---- the door ---- */

static void a_change_is_on_record_before_it_is_made(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    expect(rig, web_api_set_lockdown, NULL, "{'on': true}", 204, NULL,
           "RecordAct ada lockdown-on ;SetLockdown 1;");
    expect(rig, web_api_set_lockdown, NULL, "{'on': false}", 204, NULL,
           "RecordAct ada lockdown-off ;SetLockdown 0;");
    expect(rig, web_api_clear_lockout, NULL, NULL, 204, NULL,
           "RecordAct ada lockout-clear ;ClearLockout;");
    expect(rig, web_api_set_lockdown, NULL, "{'on': 1}", 400, "invalid-member", "");
    expect(rig, web_api_set_lockdown, NULL, "{}", 400, "invalid-member", "");
}

static void what_cannot_be_recorded_is_not_done(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    fail_with(rig, ISO_CONTRACT_RECORD_ACT, ISO_CONTRACT_ERROR_STORAGE);
    expect(rig, web_api_set_lockdown, NULL, "{'on': true}", 507, "storage",
           "RecordAct ada lockdown-on ;");
    expect(rig, web_api_clear_lockout, NULL, NULL, 507, "storage", "RecordAct ada lockout-clear ;");
    expect(rig, web_api_remove_person, "bo", NULL, 507, "storage", "RecordAct ada remove bo;");
    expect(rig, web_api_change_person, "bo", "{'name': 'eve'}", 507, "storage",
           "RecordAct ada rename bo;");
    expect(rig, web_api_change_person, "bo", "{'valid_from_s': 5}", 507, "storage",
           "RecordAct ada validity bo;");
    expect(rig, web_api_verify_log, NULL, NULL, 507, "storage", "RecordAct ada log-verify ;");
    fail_with(rig, ISO_CONTRACT_SET_LOCKDOWN, ISO_CONTRACT_ERROR_STORAGE);
    expect(rig, web_api_set_lockdown, NULL, "{'on': true}", 507, "storage",
           "RecordAct ada lockdown-on ;SetLockdown 1;");
}

/* Makes a request whose session ends while the daemon writes the record. */
static void expect_nothing_done(struct rig *rig, handler *handle, const char *part,
                                const char *body, const char *calls)
{
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, rig_session(rig), body);
    exchange.part = part;
    rig->service.trace[0] = '\0';
    handle(&rig->api, &exchange);
    web_session_end(&rig->sessions, exchange.session);
    rig_expect(rig->event, &exchange, 401, "login-required");
    rig_run(rig->event, 100);
    assert_string_equal(rig->service.trace, calls);
    rig_exchange_done(&exchange);
}

static void nothing_is_done_for_a_session_that_has_ended_meanwhile(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    expect_nothing_done(rig, web_api_set_lockdown, NULL, "{'on': false}",
                        "RecordAct ada lockdown-off ;");
    expect_nothing_done(rig, web_api_clear_lockout, NULL, NULL, "RecordAct ada lockout-clear ;");
    expect_nothing_done(rig, web_api_set_setting, "decision.level", "{'value': 'strict'}",
                        "RecordAct ada setting-set ;");
    expect_nothing_done(rig, web_api_reset_setting, "decision.level", NULL,
                        "RecordAct ada setting-reset ;");
    expect_nothing_done(rig, web_api_remove_person, "bo", NULL, "RecordAct ada remove bo;");
    expect_nothing_done(rig, web_api_change_person, "bo", "{'name': 'eve'}",
                        "RecordAct ada rename bo;");
    expect_nothing_done(rig, web_api_change_person, "bo", "{'valid_from_s': 5}",
                        "RecordAct ada validity bo;");
    expect_nothing_done(rig, web_api_verify_log, NULL, "{}", "RecordAct ada log-verify ;");
}

static void every_request_is_answered_while_the_daemon_is_gone(void **state)
{
    static const struct {
        handler *handle;
        const char *body;
    } requests[] = {
        {web_api_get_settings, NULL},
        {web_api_set_lockdown, "{'on': true}"},
        {web_api_clear_lockout, NULL},
        {web_api_list_people, NULL},
        {web_api_change_person, "{'name': 'eve'}"},
        {web_api_remove_person, NULL},
        {web_api_read_log, NULL},
        {web_api_verify_log, NULL},
        {web_api_get_outline, NULL},
        {web_api_get_relief, NULL},
        {web_api_begin_enrolment, "{'person': 'eve', 'consent': true}"},
    };
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig_service_stop(&rig->service);
    rig_wait_daemon(rig, false);
    for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
        expect(rig, requests[i].handle, "bo", requests[i].body, 503, "no-daemon", "");
    }
    struct web_exchange exchange = rig_exchange(WEB_ROLE_OBSERVER, 1, NULL);
    web_api_get_status(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    assert_true(json_is_false(json_object_get(exchange.json, "daemon")));
    assert_int_equal(json_object_size(json_object_get(exchange.json, "status")), 0);
    rig_exchange_done(&exchange);
}

/* ---- health ---- */

static const char *state_of(const json_t *health, const char *subject, const char **remedy)
{
    const json_t *check;
    size_t i;
    json_array_foreach(json_object_get(health, "checks"), i, check)
    {
        if (strcmp(json_string_value(json_object_get(check, "subject")), subject) == 0) {
            *remedy = json_string_value(json_object_get(check, "remedy"));
            return json_string_value(json_object_get(check, "state"));
        }
    }
    return "";
}

static void expect_health(struct rig *rig, const char *subject, const char *state, bool has_remedy)
{
    struct web_exchange exchange = rig_exchange(WEB_ROLE_OBSERVER, 1, NULL);
    const char *remedy = NULL;
    web_api_get_health(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    assert_string_equal(state_of(exchange.json, subject, &remedy), state);
    assert_int_equal(remedy != NULL, has_remedy);
    assert_string_equal(json_string_value(json_object_get(exchange.json, "version")),
                        ISOTHERM_VERSION);
    const json_t *certificate = json_object_get(exchange.json, "certificate");
    assert_string_equal(json_string_value(json_object_get(certificate, "fingerprint")), "AB:CD");
    assert_int_equal(json_integer_value(json_object_get(certificate, "ends_s")),
                     rig->certificate.ends_s);
    assert_true(json_is_array(json_object_get(exchange.json, "history")));
    if (strcmp(state, "bad") == 0) {
        assert_true(json_is_false(json_object_get(exchange.json, "healthy")));
    }
    rig_exchange_done(&exchange);
}

static void health_knows_the_daemon_and_the_certificate(void **state)
{
    struct rig *rig = *state;
    const int64_t now_s = (int64_t)time(NULL);
    if (!rig) {
        skip();
    }
    expect_health(rig, "sensor", "good", false);
    expect_health(rig, "certificate", "good", false);
    rig->certificate.ends_s = now_s + INT64_C(29) * 86400;
    expect_health(rig, "certificate", "odd", true);
    rig->certificate.ends_s = now_s - 1;
    expect_health(rig, "certificate", "bad", true);
    rig->service.lockdown = true;
    rig_run(rig->event, 1500);
    expect_health(rig, "service", "bad", true);
    rig_service_stop(&rig->service);
    rig_wait_daemon(rig, false);
    expect_health(rig, "daemon", "bad", true);
}

/* ---- people ---- */

static double cpu_ms(void)
{
    struct timespec used;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return (double)used.tv_sec * 1e3 + (double)used.tv_nsec / 1e6;
}

static void ten_thousand_people_are_listed_by_name(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.n_people = 10000;
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, 1, NULL);
    const double begin_ms = cpu_ms();
    web_api_list_people(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    print_message("10,000 people: %.1f ms of the processor, with the stand-in and the test\n",
                  cpu_ms() - begin_ms);
    const json_t *people = json_object_get(exchange.json, "people");
    assert_int_equal(json_array_size(people), 10000);
    const json_t *person = json_array_get(people, 1234);
    assert_string_equal(json_string_value(json_object_get(person, "name")), "person 01234");
    assert_int_equal(json_integer_value(json_object_get(person, "enrolled_s")), 1700001234);
    assert_int_equal(json_integer_value(json_object_get(person, "templates")), 5);
    assert_true(json_is_null(json_object_get(person, "last_seen_s")));
    rig_exchange_done(&exchange);
}

static void a_person_is_renamed_first_and_limited_then(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.n_people = 3;
    expect(rig, web_api_change_person, "bo", "{'name': 'person 00001'}", 200, NULL,
           "RecordAct ada rename bo;RenamePerson bo person 00001;");
    expect(rig, web_api_change_person, "bo", "{'valid_from_s': 5, 'valid_until_s': 0}", 200, NULL,
           "RecordAct ada validity bo;SetValidity bo valid-from=5 valid-until=0;");
    expect(rig, web_api_change_person, "bo",
           "{'name': 'person 00002', 'valid_until_s': 77, 'expired': true}", 200, NULL,
           "RecordAct ada rename bo;RenamePerson bo person 00002;"
           "RecordAct ada validity person 00002;"
           "SetValidity person 00002 valid-until=77 expired=1;");
    /* A name that an earlier version allowed cannot be put on record by RecordAct. */
    expect(rig, web_api_change_person, " bo", "{'valid_from_s': 5}", 200, NULL,
           "RecordAct ada validity ;SetValidity  bo valid-from=5;");
}

static void a_change_that_is_refused_halfway_says_what_was_done(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    fail_with(rig, ISO_CONTRACT_SET_VALIDITY, ISO_CONTRACT_ERROR_INVALID_ARGUMENT);
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, 1,
                                                "{'name': 'eve', 'valid_from_s': 5}");
    exchange.part = "bo";
    web_api_change_person(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 400, "invalid-limits");
    assert_string_equal(exchange.detail, "The person was renamed to \"eve\", but the limits were "
                                         "not changed: as the script says");
    rig_exchange_done(&exchange);
}

/* The session ends when the stand-in has had the second record, and before its answer comes: each
 * round of the loop handles one thing. */
static void a_session_that_ends_halfway_says_what_was_done(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    const uint64_t session = rig_session(rig);
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, session,
                                                "{'name': 'eve', 'valid_from_s': 5}");
    exchange.part = "bo";
    rig->service.trace[0] = '\0';
    web_api_change_person(&rig->api, &exchange);
    while (!strstr(rig->service.trace, "RecordAct ada validity")) {
        assert_true(sd_event_run(rig->event, UINT64_MAX) >= 0);
    }
    web_session_end(&rig->sessions, session);
    rig_expect(rig->event, &exchange, 401, "login-required");
    assert_string_equal(exchange.detail, "The person was renamed to \"eve\", but the limits were "
                                         "not changed: the session has ended");
    assert_null(strstr(rig->service.trace, "SetValidity"));
    rig_exchange_done(&exchange);
}

static void the_remark_of_a_rename_is_in_the_answer(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.n_people = 3;
    for (int i = 0; i < 2; i++) {
        rig->service.remark = i == 0 ? "the file of card numbers has the old name" : NULL;
        struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, RIG_SESSION,
                                                    "{'name': 'person 00001'}");
        exchange.part = "bo";
        web_api_change_person(&rig->api, &exchange);
        rig_expect(rig->event, &exchange, 200, NULL);
        const json_t *remark = json_object_get(exchange.json, "remark");
        assert_int_equal(remark != NULL, i == 0);
        if (remark) {
            assert_string_equal(json_string_value(remark), rig->service.remark);
        }
        rig_exchange_done(&exchange);
    }
}

static void a_wrong_change_of_a_person_changes_nothing(void **state)
{
    static const struct {
        const char *body, *code;
    } wrong[] = {
        {"{}", "invalid-member"},
        {"{'name': 7}", "invalid-name"},
        {"{'name': ''}", "invalid-name"},
        {"{'name': ' x'}", "invalid-name"},
        {"{'name': 'eve', 'valid_from_s': 'today'}", "invalid-limits"},
        {"{'name': 'eve', 'valid_from_s': -1}", "invalid-limits"},
        {"{'valid_from_s': 8, 'valid_until_s': 8, 'expired': true}", "invalid-limits"},
        {"{'name': 'eve', 'valid_until_s': 8}", "invalid-limits"},
        {"{'valid_until_s': 8, 'expired': 1}", "invalid-member"},
    };
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        expect(rig, web_api_change_person, "bo", wrong[i].body, 400, wrong[i].code, "");
    }
    fail_with(rig, ISO_CONTRACT_RENAME_PERSON, ISO_CONTRACT_ERROR_NAME_IN_USE);
    expect(rig, web_api_change_person, "bo", "{'name': 'eve', 'valid_from_s': 5}", 409,
           "name-in-use", "RecordAct ada rename bo;RenamePerson bo eve;");
    fail_with(rig, ISO_CONTRACT_RENAME_PERSON, ISO_CONTRACT_ERROR_NO_SUCH_PERSON);
    expect(rig, web_api_change_person, "bo", "{'name': 'eve'}", 404, "no-such-person",
           "RecordAct ada rename bo;RenamePerson bo eve;");
}

static void a_person_is_removed(void **state)
{
    char name[400];
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    expect(rig, web_api_remove_person, "bo", NULL, 204, NULL,
           "RecordAct ada remove bo;DeletePerson bo;");
    fail_with(rig, ISO_CONTRACT_DELETE_PERSON, ISO_CONTRACT_ERROR_NO_SUCH_PERSON);
    expect(rig, web_api_remove_person, "bo", NULL, 404, "no-such-person",
           "RecordAct ada remove bo;DeletePerson bo;");
    memset(name, 'x', sizeof name);
    name[sizeof name - 1] = '\0';
    expect(rig, web_api_remove_person, name, NULL, 404, "no-such-person", "");
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, rig_setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(a_change_is_on_record_before_it_is_made),
        RIG_TEST(what_cannot_be_recorded_is_not_done),
        RIG_TEST(nothing_is_done_for_a_session_that_has_ended_meanwhile),
        RIG_TEST(every_request_is_answered_while_the_daemon_is_gone),
        RIG_TEST(health_knows_the_daemon_and_the_certificate),
        RIG_TEST(ten_thousand_people_are_listed_by_name),
        RIG_TEST(a_person_is_renamed_first_and_limited_then),
        RIG_TEST(a_change_that_is_refused_halfway_says_what_was_done),
        RIG_TEST(a_session_that_ends_halfway_says_what_was_done),
        RIG_TEST(the_remark_of_a_rename_is_in_the_answer),
        RIG_TEST(a_wrong_change_of_a_person_changes_nothing),
        RIG_TEST(a_person_is_removed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
