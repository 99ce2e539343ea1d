/* isotherm settings, against a scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "tests/enroll/rigs/cli.h"

static void it_lists_what_is_in_force(void **state)
{
    const struct cli_result result = cli_run(&cli_two_people, "settings");
    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out, "[door]\n"
                                    "- backend                gpiod\n"
                                    "  unlock_ms              7000 (the configuration file has "
                                    "5000)\n"
                                    "\n[decision]\n"
                                    "  level                  balanced\n"
                                    "  margin                 0\n"
                                    "\n- takes effect at a restart only\n");
}

static void it_shows_one(void **state)
{
    (void)state;
    struct cli_result result = cli_run(&cli_two_people, "settings door.unlock_ms");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out, "door.unlock_ms = 7000\n"
                                    "  how long the door stays unlocked\n"
                                    "  allowed             a whole number, 100 to 600000\n"
                                    "  default             4000\n"
                                    "  configuration file  5000\n"
                                    "  It was changed while the daemon ran.\n");
    result = cli_run(&cli_two_people, "settings door.backend");
    assert_non_null(strstr(result.out, "with a restart of the daemon"));
    result = cli_run(&cli_two_people, "settings door.nothing --json");
    cli_expect_error(&result, 3, "no-such-setting");
}

static void a_document_has_all_of_it(void **state)
{
    (void)state;
    struct cli_result result = cli_run(&cli_two_people, "settings --json");
    json_t *document = cli_json(&result);
    const json_t *list = json_object_get(document, "settings");
    assert_int_equal(json_array_size(list), 4);
    const json_t *one = json_array_get(list, 1);
    assert_string_equal(json_string_value(json_object_get(one, "value")), "7000");
    assert_string_equal(json_string_value(json_object_get(one, "default")), "4000");
    assert_string_equal(json_string_value(json_object_get(one, "configured")), "5000");
    assert_true(json_is_true(json_object_get(one, "changeable")));
    assert_true(json_is_false(json_object_get(json_array_get(list, 0), "changeable")));
    json_decref(document);
    result = cli_run(&cli_two_people, "settings decision.level --json");
    document = cli_json(&result);
    assert_string_equal(json_string_value(json_object_get(document, "range")),
                        "convenient|balanced|strict");
    json_decref(document);
}

static void it_changes_one_and_resets_it(void **state)
{
    (void)state;
    struct cli_result result = cli_run(&cli_two_people, "settings decision.level strict");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out, "decision.level is strict from now on.\n");
    assert_string_equal(result.calls, "SetSetting decision level strict");
    result = cli_run(&cli_two_people, "settings decision.threshold -- -2.5");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "SetSetting decision threshold -2.5");
    result = cli_run(&cli_two_people, "settings door.unlock_ms --reset");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out,
                        "door.unlock_ms is 5000 from now on, as in the configuration file.\n");
    assert_string_equal(result.calls, "ResetSetting");
    result = cli_run(&cli_two_people, "settings decision.level strict --json");
    json_t *document = cli_json(&result);
    assert_string_equal(json_string_value(json_object_get(document, "value")), "strict");
    json_decref(document);
}

static void what_is_wrong_is_said(void **state)
{
    struct fake_script script = cli_two_people;
    (void)state;
    struct cli_result result = cli_run(&script, "settings level");
    cli_expect_exit(&result, 2);
    assert_non_null(strstr(result.err, "a setting looks like decision.level, not 'level'"));
    result = cli_run(&script, "settings .level");
    cli_expect_exit(&result, 2);
    result = cli_run(&script, "settings decision.");
    cli_expect_exit(&result, 2);
    result = cli_run(&script, "settings --reset");
    cli_expect_exit(&result, 2);
    result = cli_run(&script, "settings decision.level strict --reset");
    cli_expect_exit(&result, 2);
    assert_string_equal(result.calls, "");
    result = cli_run(&script, "list --reset");
    cli_expect_exit(&result, 2);
    script.fail_method = "SetSetting";
    script.fail_error = "org.isotherm.Error.InvalidArgument";
    script.fail_text = "bad value 'lax' for 'level' (convenient|balanced|strict)";
    result = cli_run(&script, "settings decision.level lax");
    cli_expect_exit(&result, 2);
    assert_non_null(strstr(result.err, script.fail_text));
    script.fail_error = "org.freedesktop.DBus.Error.AccessDenied";
    result = cli_run(&script, "settings decision.level strict --json");
    cli_expect_error(&result, 1, "access-denied");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_lists_what_is_in_force), cmocka_unit_test(it_shows_one),
        cmocka_unit_test(a_document_has_all_of_it),  cmocka_unit_test(it_changes_one_and_resets_it),
        cmocka_unit_test(what_is_wrong_is_said),
    };

    if (!cli_find_bus()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, NULL, cli_teardown);
}
