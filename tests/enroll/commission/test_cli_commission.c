/* isotherm doctor --commission against a scripted daemon: a door that passes, one that does not,
 * and a user who may not do it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/commission/checklist.h"
#include "tests/enroll/rigs/cli.h"
#include "tests/support/scratch.h"

/* Returns a command line with a file in which every item that asks has the answer "yes". */
static const char *command_with_answers(const char *scratch, const char *options)
{
    static char command[512];
    const char *path = scratch_path(scratch, "answers");
    FILE *out = fopen(path, "w");

    assert_non_null(out);
    fputs("by = Ada Example\n", out);
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        if (cli_checklist_asks(&cli_checklist[i])) {
            fprintf(out, "%s = yes\n", cli_checklist[i].item);
        }
    }
    assert_int_equal(fclose(out), 0);
    (void)snprintf(command, sizeof command, "doctor --commission --answers %s%s", path, options);
    return command;
}

static struct fake_script sound_door(void)
{
    struct fake_script script = cli_two_people;
    script.key_place = "credential";
    script.frames_come = true;
    return script;
}

/* Every item gets to the daemon, and only good answers. */
static void a_door_without_faults_passes(void **state)
{
    const struct fake_script script = sound_door();
    const struct cli_result result = cli_run(&script, command_with_answers(*state, ""));
    char item[96];

    cli_expect_exit(&result, 0);
    assert_non_null(strstr(result.out, "ok       frames       30.0 frames a second\n"));
    assert_non_null(strstr(result.out, "ok       key          credential\n"));
    assert_non_null(strstr(result.out, "Outcome: passed; record 4711 of the audit log.\n"));
    assert_non_null(strstr(result.calls, "TestDoor;RecordCommission Ada Example daemon=ok "));
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        (void)snprintf(item, sizeof item, " %s=%s", cli_checklist[i].item,
                       cli_checklist[i].way == CLI_WAY_PERSON ? "yes" : "ok");
        if (!strstr(result.calls, item)) {
            fail_msg("not recorded: %s, but %s", item, result.calls);
        }
    }
}

/* The exit code is that of the outcome, which the daemon decides. */
static void the_outcome_decides_the_exit_code(void **state)
{
    static const struct {
        const char *outcome;
        int exit;
    } cases[] = {{"passed", 0}, {"incomplete", 1}, {"failed", 4}, {"of-a-newer-daemon", 4}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct fake_script script = sound_door();
        script.commissioned = cases[i].outcome;
        const struct cli_result result = cli_run(&script, command_with_answers(*state, " --json"));
        json_t *document = cli_json(&result);
        cli_expect_exit(&result, cases[i].exit);
        assert_string_equal(json_string_value(json_object_get(document, "outcome")),
                            cases[i].outcome);
        assert_int_equal(json_integer_value(json_object_get(document, "record")), 4711);
        json_decref(document);
    }
}

/* A fault of the doctor that has no item of its own is not lost. */
static void other_faults_of_the_doctor_are_recorded(void **state)
{
    struct fake_script script = sound_door();
    script.counter_fault = "away";
    script.counter_fault_code = "tpm-missing";
    script.commissioned = "failed";
    const struct cli_result result = cli_run(&script, command_with_answers(*state, ""));

    cli_expect_exit(&result, 4);
    assert_non_null(strstr(result.out, "fault    doctor       counter: away\n"));
    assert_non_null(strstr(result.calls, " doctor=fault "));
}

/* It ends before a person has answered questions for nothing, and before the relay is switched. */
static void whoever_may_not_verify_the_log_is_not_asked(void **state)
{
    struct fake_script script = sound_door();
    script.fail_method = "VerifyLog";
    script.fail_error = "org.freedesktop.DBus.Error.AccessDenied";
    const struct cli_result result = cli_run(&script, command_with_answers(*state, " --json"));

    cli_expect_error(&result, 1, "access-denied");
    assert_null(strstr(result.calls, "TestDoor"));
    assert_null(strstr(result.calls, "RecordCommission"));
}

static void a_record_that_fails_is_a_fault(void **state)
{
    struct fake_script script = sound_door();
    script.fail_method = "RecordCommission";
    script.fail_error = "org.isotherm.Error.Storage";
    const struct cli_result result = cli_run(&script, command_with_answers(*state, " --json"));

    cli_expect_error(&result, 4, "storage");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_door_without_faults_passes),
        TEST(the_outcome_decides_the_exit_code),
        TEST(other_faults_of_the_doctor_are_recorded),
        TEST(whoever_may_not_verify_the_log_is_not_asked),
        TEST(a_record_that_fails_is_a_fault),
    };

    if (!cli_find_bus()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, NULL, cli_teardown);
}
