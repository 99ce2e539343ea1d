/* The handlers of the log. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>

#include "tests/enroll/web/rigs/handler_rig.h"

static void write_record(int i, char *line, size_t size)
{
    (void)snprintf(line, size, "{\"sequence\": %d, \"event\": \"door\", \"note\": \"a \\\"b\\\"\"}",
                   i);
}

/* Reads the log and expects these records, from first to last; 0: none. */
static void expect_log(struct rig *rig, const char *before, const char *from, const char *max,
                       int first, int last)
{
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, 1, NULL);
    const char *names[] = {"before", before, "from", from, "max", max};
    int n = 0;
    for (int i = 0; i < 6; i += 2) {
        if (names[i + 1]) {
            exchange.query[n++] = names[i];
            exchange.query[n++] = names[i + 1];
        }
    }
    web_api_read_log(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    assert_int_equal(json_integer_value(json_object_get(exchange.json, "last")),
                     rig->service.last_record);
    const json_t *records = json_object_get(exchange.json, "records");
    assert_int_equal(json_array_size(records), first ? last - first + 1 : 0);
    for (int i = first; first && i <= last; i++) {
        const json_t *record = json_array_get(records, (size_t)(i - first));
        assert_int_equal(json_integer_value(json_object_get(record, "sequence")), i);
    }
    rig_exchange_done(&exchange);
}

static void the_log_is_read_in_parts(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.record = write_record;
    rig->service.last_record = 1500;
    expect_log(rig, NULL, NULL, NULL, 1401, 1500);
    expect_log(rig, NULL, NULL, "1000", 501, 1500);
    expect_log(rig, "1401", NULL, NULL, 1301, 1400);
    expect_log(rig, "30", NULL, NULL, 1, 29);
    expect_log(rig, "1", NULL, NULL, 0, 0);
    expect_log(rig, NULL, "7", "3", 7, 9);
    expect_log(rig, "9", "7", "5", 7, 8);
    expect_log(rig, NULL, "1500", NULL, 1500, 1500);
    expect_log(rig, NULL, "1501", NULL, 0, 0);
    expect_log(rig, "9999", NULL, "2", 1499, 1500);
    static const char *const wrong[][2] = {{"before", "0"}, {"before", "x"}, {"from", "-1"},
                                           {"max", "0"},    {"max", "1001"}, {"max", ""}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, 1, NULL);
        exchange.query[0] = wrong[i][0];
        exchange.query[1] = wrong[i][1];
        web_api_read_log(&rig->api, &exchange);
        rig_expect(rig->event, &exchange, 400, "invalid-parameter");
        rig_exchange_done(&exchange);
    }
}

static void write_damaged(int i, char *line, size_t size)
{
    (void)snprintf(line, size, "{\"sequence\": %d, ", i);
}

static void a_record_that_is_no_json_is_not_passed_on(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.record = write_damaged;
    rig->service.last_record = 2;
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, 1, NULL);
    web_api_read_log(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 500, NULL);
    rig_exchange_done(&exchange);
}

static void the_log_is_verified(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, 1, "{}");
    web_api_verify_log(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    json_t *wanted = json_pack("{s:b, s:i, s:i, s:s, s:i, s:s}", "sound", 0, "first", 2, "last", 9,
                               "head", "9:ab", "flaw_at", 7, "flaw", "it was changed");
    assert_true(json_equal(exchange.json, wanted));
    json_decref(wanted);
    rig_exchange_done(&exchange);
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, rig_setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(the_log_is_read_in_parts),
        RIG_TEST(a_record_that_is_no_json_is_not_passed_on),
        RIG_TEST(the_log_is_verified),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
