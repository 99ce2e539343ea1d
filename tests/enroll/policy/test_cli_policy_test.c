/* isotherm policy test, against a scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "tests/enroll/rigs/cli.h"

static void it_answers_in_one_sentence(void **state)
{
    struct fake_script script = cli_two_people;
    struct cli_result result = cli_run(
        &script, "policy test --person anna --at 2026-11-29T09:00Z --door front --shown face,card");
    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "TestAccess anna front 1795942800 face card");
    assert_string_equal(result.out,
                        "anna would be let in at front on Sunday 2026-11-29 at 09:00.\n");
    script.outcome = "deny";
    script.reason = "NotPermittedAtThisTime";
    result = cli_run(&script, "policy test --person anna --at 2026-11-29T09:00Z");
    cli_expect_exit(&result, 1);
    assert_string_equal(result.calls, "TestAccess anna - 1795942800 face");
    assert_string_equal(result.out, "anna would not be let in at front on Sunday 2026-11-29 at "
                                    "09:00: not at this time.\n");
    script.outcome = "want";
    result = cli_run(&script, "policy test --person anna --at 2026-11-29T09:00Z");
    cli_expect_exit(&result, 6);
    assert_string_equal(result.out, "anna would be asked for more at front on Sunday 2026-11-29 at "
                                    "09:00: card and PIN.\n");
    script.companion = true;
    result = cli_run(&script, "policy test --person anna --at 2026-11-29T09:00Z");
    assert_non_null(strstr(result.out, "at 09:00: card and PIN and a second person.\n"));
}

static void it_answers_as_json(void **state)
{
    struct fake_script script = cli_two_people;
    script.outcome = "deny";
    script.reason = "Unauthorized";
    const struct cli_result result = cli_run(&script,
                                             "policy test --person anna --at @1795942800 --json");
    (void)state;
    cli_expect_exit(&result, 1);
    json_t *document = cli_json(&result);
    json_t *expected = json_pack("{s:s, s:s, s:[], s:s, s:s, s:b, s:s, s:I}", "outcome", "deny",
                                 "reason", "Unauthorized", "wanted", "level", "face",
                                 "access-point", "front", "companion", 0, "person", "anna", "time",
                                 (json_int_t)1795942800);
    assert_true(json_equal(document, expected));
    json_decref(document);
    json_decref(expected);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_answers_in_one_sentence),
        cmocka_unit_test(it_answers_as_json),
    };

    setenv("TZ", "UTC", 1);
    if (!cli_find_bus()) {
        return 77;
    }
    return cmocka_run_group_tests(tests, NULL, cli_teardown);
}
