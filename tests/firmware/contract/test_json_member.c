/* Members of a record of the log are found by their names, whatever text other values have. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "firmware/contract/json_line.h"
#include "firmware/contract/json_member.h"

static void finds_what_was_written(void **state)
{
    struct iso_json_line line;
    char value[32] = "untouched";
    (void)state;
    iso_json_line_begin(&line);
    iso_json_line_integer(&line, "sequence", -7);
    iso_json_line_string(&line, "person", "x\",\"event\":\"clock\\");
    iso_json_line_number(&line, "score", NAN);
    iso_json_line_string(&line, "event", "visit");
    iso_json_line_string(&line, "note", "");
    assert_true(iso_json_line_end(&line) > 0);
    assert_true(iso_json_member(line.text, "event", value, sizeof value));
    assert_string_equal(value, "visit"); /* and not the text in the name */
    assert_true(iso_json_member(line.text, "note", value, sizeof value));
    assert_string_equal(value, "");
    assert_true(iso_json_member(line.text, "person", value, sizeof value));
    assert_string_equal(value, "x\\\",\\\"event\\\":\\\"clock\\\\"); /* as it is written */
}

static void refuses_what_is_not_there(void **state)
{
    static const char *const texts[] = {
        "",
        "{}",
        "{\"a\":1}",
        "{\"b\":\"even\"}",
        "{\"eventful\":\"x\",\"even\":\"y\"}",
        "{\"event\":12}",
        "{\"event\":null,\"b\":\"c\"}",
        "{\"a\":\"event\"}",
        "{\"event",
        "{\"event\"",
        "{\"event\":",
        "{\"event\":\"",
        "{\"event\":\"abc",
        "{\"event\":\"abc\\",
        "{\"event\":\"abc\"",
        "{\"a\":\"x\" \"event\":\"abc\"}",
        "{\"event\":\"0123456789\"}", /* too long for the value */
        "\"event\":\"abc\"",
    };
    char value[10] = "untouched";
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (iso_json_member(texts[i], "event", value, sizeof value) ||
            strcmp(value, "untouched") != 0) {
            fail_msg("finds '%s' in %s", value, texts[i]);
        }
    }
    assert_true(iso_json_member("{\"event\":\"012345678\"}", "event", value, sizeof value));
    assert_string_equal(value, "012345678");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_what_was_written),
        cmocka_unit_test(refuses_what_is_not_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
