/* The handlers of the settings: the list, a change on record, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

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

static void the_settings_are_those_of_the_daemon(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, 1, NULL);
    web_api_get_settings(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    json_t *wanted = json_pack(
        "{s:[{s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:b}, {s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:b}]}",
        "settings", "section", "door", "key", "unlock_ms", "value", "3000", "default", "5000",
        "range", "100..60000", "help", "how long", "configured", "4000", "changeable", 1, "section",
        "sensor", "key", "backend", "value", "replay", "default", "", "range", "a word", "help",
        "says \"which\"", "configured", "replay", "changeable", 0);
    assert_non_null(wanted);
    assert_true(json_equal(exchange.json, wanted));
    json_decref(wanted);
    rig_exchange_done(&exchange);
}

static void expect_setting(struct rig *rig, handler *handle, const char *body, const char *value)
{
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, 1, body);
    exchange.part = "door.unlock_ms";
    handle(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    assert_string_equal(json_string_value(json_object_get(exchange.json, "section")), "door");
    assert_string_equal(json_string_value(json_object_get(exchange.json, "key")), "unlock_ms");
    assert_string_equal(json_string_value(json_object_get(exchange.json, "value")), value);
    rig_exchange_done(&exchange);
}

static void a_setting_is_changed_and_reset_on_record(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.trace[0] = '\0';
    expect_setting(rig, web_api_set_setting, "{'value': '7000'}", "7000");
    assert_string_equal(rig->service.trace,
                        "RecordAct ada setting-set ;SetSetting door unlock_ms 7000;");
    rig->service.trace[0] = '\0';
    expect_setting(rig, web_api_reset_setting, NULL, "4000");
    assert_string_equal(rig->service.trace,
                        "RecordAct ada setting-reset ;ResetSetting door unlock_ms;");
}

static void a_setting_that_is_wrong_is_refused(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    expect(rig, web_api_set_setting, "level", "{'value': 'x'}", 404, "no-such-setting", "");
    expect(rig, web_api_set_setting, ".level", "{'value': 'x'}", 404, "no-such-setting", "");
    expect(rig, web_api_reset_setting, "decision.", NULL, 404, "no-such-setting", "");
    expect(rig, web_api_set_setting, "decision.level", "{}", 400, "invalid-member", "");
    expect(rig, web_api_set_setting, "decision.level", "{'value': 3}", 400, "invalid-member", "");
    expect(rig, web_api_set_setting, "decision.level", "{'value': ''}", 400, "invalid-member", "");
    rig->service.fail_method = ISO_CONTRACT_SET_SETTING;
    rig->service.fail_error = ISO_CONTRACT_ERROR_INVALID_ARGUMENT;
    expect(rig, web_api_set_setting, "decision.level", "{'value': 'lax'}", 400, "invalid-setting",
           "RecordAct ada setting-set ;SetSetting decision level lax;");
    rig->service.fail_error = ISO_CONTRACT_ERROR_STORAGE;
    expect(rig, web_api_set_setting, "decision.level", "{'value': 'lax'}", 507, "storage",
           "RecordAct ada setting-set ;SetSetting decision level lax;");
    rig->service.fail_error = ISO_CONTRACT_ERROR_ACTION;
    expect(rig, web_api_set_setting, "decision.level", "{'value': 'lax'}", 409, "enrolment-running",
           "RecordAct ada setting-set ;SetSetting decision level lax;");
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, rig_setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(the_settings_are_those_of_the_daemon),
        RIG_TEST(a_setting_is_changed_and_reset_on_record),
        RIG_TEST(a_setting_that_is_wrong_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
