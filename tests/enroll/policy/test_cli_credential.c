/* isotherm credential, against a scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>
#include <unistd.h>

#include "tests/enroll/rigs/cli.h"

/* Runs the words with a text as standard input. */
static struct cli_result run_with(const struct fake_script *script, const char *words,
                                  const char *input)
{
    int ends[2];
    const int kept = dup(STDIN_FILENO);

    assert_true(kept >= 0);
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], input, strlen(input)), strlen(input));
    close(ends[1]);
    assert_int_equal(dup2(ends[0], STDIN_FILENO), STDIN_FILENO);
    close(ends[0]);
    const struct cli_result result = cli_run(script, words);
    assert_int_equal(dup2(kept, STDIN_FILENO), STDIN_FILENO);
    close(kept);
    return result;
}

static void it_shows(void **state)
{
    struct fake_script script = cli_two_people;
    script.credential = "{\"enabled\":false,\"disabled_reason\":\"left\",\"cards\":[\"17/4711\","
                        "\"9\"],\"pin\":true,\"duress_pin\":false,\"profiles\":[\"staff\"],"
                        "\"no_antipassback\":true,\"needs_escort\":false,\"two_person_class\":3}";
    struct cli_result result = cli_run(&script, "credential show anna");
    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetCredential anna");
    assert_string_equal(result.out, "anna                 disabled: left\n"
                                    "cards                17/4711, 9\n"
                                    "PIN                  yes\n"
                                    "duress PIN           no\n"
                                    "access profiles      staff\n"
                                    "antipassback         no\n"
                                    "needs an escort      no\n"
                                    "class of pairs       3\n");
    result = cli_run(&script, "credential show anna --json");
    json_t *document = cli_json(&result), *credential = json_loads(script.credential, 0, NULL);
    assert_string_equal(json_string_value(json_object_get(document, "person")), "anna");
    assert_true(json_equal(json_object_get(document, "credential"), credential));
    json_decref(document);
    json_decref(credential);
}

static void it_changes(void **state)
{
    static const struct {
        const char *words, *calls;
    } cases[] = {
        {"credential set anna --card 17/4711 --card 9 --profile staff",
         "SetCredential anna {\"cards\":[\"17/4711\",\"9\"],\"profiles\":[\"staff\"]}"},
        {"credential set anna --no-cards --no-profiles",
         "SetCredential anna {\"cards\":[],\"profiles\":[]}"},
        {"credential set anna --disable lost",
         "SetCredential anna {\"enabled\":false,\"disabled_reason\":\"lost\"}"},
        {"credential set anna --enable",
         "SetCredential anna {\"enabled\":true,\"disabled_reason\":\"\"}"},
        {"credential set anna --escort yes --antipassback no --class 0",
         "SetCredential anna {\"needs_escort\":true,\"no_antipassback\":true,"
         "\"two_person_class\":0}"},
        {"credential set anna --escort no --antipassback yes --class 255",
         "SetCredential anna {\"needs_escort\":false,\"no_antipassback\":false,"
         "\"two_person_class\":255}"},
        {"credential set anna --no-pin --no-duress-pin",
         "SetCredential anna {\"pin\":null,\"duress_pin\":null}"},
    };
    const struct fake_script script = cli_two_people;

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct cli_result result = cli_run(&script, cases[i].words);
        cli_expect_exit(&result, 0);
        assert_string_equal(result.calls, cases[i].calls);
    }
}

static void it_asks_for_pins(void **state)
{
    const struct fake_script script = cli_two_people;
    struct cli_result result = run_with(&script, "credential set anna --pin", "1234\n");
    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "SetCredential anna {\"pin\":\"1234\"}");
    result = run_with(&script, "credential set anna --duress-pin --pin --card 9",
                      "123456789\n0000\n");
    cli_expect_exit(&result, 0);
    assert_string_equal(
        result.calls,
        "SetCredential anna {\"pin\":\"123456789\",\"duress_pin\":\"0000\",\"cards\":[\"9\"]}");
    result = run_with(&script, "credential set anna --duress-pin", "0042");
    assert_string_equal(result.calls, "SetCredential anna {\"duress_pin\":\"0042\"}");
}

static void what_is_no_pin(void **state)
{
    static const char *const inputs[] = {"",       "\n",      "123\n",  "1234567890\n",
                                         "12a4\n", "1234 \n", "12\"4\n"};
    const struct fake_script script = cli_two_people;

    (void)state;
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++) {
        const struct cli_result result = run_with(&script, "credential set anna --pin --json",
                                                  inputs[i]);
        cli_expect_error(&result, 2, "pin");
        assert_string_equal(result.calls, "");
    }
}

static void faults_of_the_daemon(void **state)
{
    struct fake_script script = cli_two_people;
    script.fail_method = "SetCredential";
    script.fail_error = "org.isotherm.Error.NoSuchPerson";
    struct cli_result result = cli_run(&script, "credential set ada --enable --json");
    (void)state;
    cli_expect_error(&result, 3, "no-such-person");
    script.fail_method = "GetCredential";
    script.fail_error = "org.freedesktop.DBus.Error.AccessDenied";
    result = cli_run(&script, "credential show anna --json");
    cli_expect_error(&result, 1, "access-denied");
    script = cli_two_people;
    script.credential = "no json";
    result = cli_run(&script, "credential show anna --json");
    cli_expect_error(&result, 4, "bad-reply");
}

static void wrong_command_lines(void **state)
{
    static const char *const lines[] = {"credential",
                                        "credential show",
                                        "credential erase anna",
                                        "credential set anna",
                                        "credential show anna --enable",
                                        "credential set anna --card 9 --no-cards",
                                        "credential set anna --profile x --no-profiles",
                                        "credential set anna --pin --no-pin",
                                        "credential set anna --duress-pin --no-duress-pin",
                                        "credential set anna --enable --disable lost",
                                        "credential set anna --escort maybe",
                                        "credential set anna --class 256",
                                        "credential set anna --pin 1234"};
    const struct fake_script script = cli_two_people;

    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        const struct cli_result result = cli_run(&script, lines[i]);
        cli_expect_exit(&result, 2);
        assert_string_equal(result.calls, "");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_shows),
        cmocka_unit_test(it_changes),
        cmocka_unit_test(it_asks_for_pins),
        cmocka_unit_test(what_is_no_pin),
        cmocka_unit_test(faults_of_the_daemon),
        cmocka_unit_test(wrong_command_lines),
    };

    if (!cli_find_bus()) {
        return 77;
    }
    return cmocka_run_group_tests(tests, NULL, cli_teardown);
}
