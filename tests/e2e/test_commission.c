/* isotherm doctor --commission with a running daemon: the machine's checks, answers from a file and
 * at a terminal, and the record in the audit log. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <pty.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "enroll/cli/commission/checklist.h"
#include "tests/e2e/appliance.h"
#include "tests/support/child_end.h"
#include "tests/support/scratch.h"

enum { RECORDS = CLI_CHECKLIST_ITEMS + 1 };

/* Writes a file with "yes" for every item that asks, but "skip" with a reason for `skipped`.
 * Returns the command line that uses it. */
static const char *command_with_answers(const struct appliance *appliance, const char *skipped)
{
    static char command[512];
    const char *path = scratch_path(appliance->directory, "answers");
    FILE *out = fopen(path, "w");

    assert_non_null(out);
    fputs("by = Ada Example\n", out);
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        if (cli_checklist_asks(&cli_checklist[i])) {
            fprintf(out, "%s = %s\n", cli_checklist[i].item,
                    strcmp(cli_checklist[i].item, skipped) == 0 ? "skip not mounted yet" : "yes");
        }
    }
    assert_int_equal(fclose(out), 0);
    (void)snprintf(command, sizeof command, "doctor --commission --answers %s", path);
    return command;
}

/* The member of an item in the document of the command. */
static const char *item_text(const json_t *document, const char *item, const char *member)
{
    const json_t *entry;
    size_t i;

    json_array_foreach(json_object_get(document, "items"), i, entry)
    {
        if (strcmp(json_string_value(json_object_get(entry, "item")), item) == 0) {
            const char *text = json_string_value(json_object_get(entry, member));
            return text ? text : "";
        }
    }
    fail_msg("no item '%s'", item);
    return "";
}

/* How many records of the log are of commissionings. */
static size_t count_records(const struct appliance *appliance)
{
    json_t *document = appliance_run_json(appliance, "log --event commission -n 1000", NULL, 0);
    const size_t n = json_array_size(json_object_get(document, "records"));

    json_decref(document);
    return n;
}

static void without_a_terminal_it_needs_answers(void **state)
{
    const struct appliance_result *result = appliance_run(*state, "doctor --commission", NULL);

    appliance_expect(result, 2);
    assert_non_null(strstr(result->err, "give --answers FILE"));
    appliance_expect(appliance_run(*state, "doctor --answers /dev/null", NULL), 2);
    result = appliance_run(*state, "doctor --commission --answers /nonexistent/answers", NULL);
    appliance_expect(result, 2);
    assert_non_null(strstr(result->err, "/nonexistent/answers"));
    assert_int_equal(count_records(*state), 0);
}

/* There is nobody in the gallery, nothing before the camera, and the door has no lines. */
static void what_the_machine_finds_is_on_record(void **state)
{
    const struct appliance *appliance = *state;
    json_t *document = appliance_run_json(appliance, command_with_answers(appliance, "tamper"),
                                          NULL, 4);

    assert_string_equal(json_string_value(json_object_get(document, "outcome")), "failed");
    assert_string_equal(json_string_value(json_object_get(document, "by")), "Ada Example");
    assert_int_equal(json_array_size(json_object_get(document, "items")), CLI_CHECKLIST_ITEMS);
    assert_string_equal(item_text(document, "daemon", "answer"), "ok");
    assert_string_equal(item_text(document, "frames", "answer"), "fault");
    assert_string_equal(item_text(document, "frames", "remark"), "0.0 frames a second");
    assert_string_equal(item_text(document, "gallery", "answer"), "warning");
    assert_string_equal(item_text(document, "lines", "remark"), "null: nothing is switched");
    assert_string_equal(item_text(document, "key", "answer"), "warning");
    assert_string_equal(item_text(document, "log", "answer"), "ok");
    assert_string_equal(item_text(document, "clock", "answer"), "ok");
    assert_string_equal(item_text(document, "relay", "answer"), "ok");
    assert_string_equal(item_text(document, "relay", "checked_by"), "machine");
    assert_string_equal(item_text(document, "photo", "answer"), "yes");
    assert_string_equal(item_text(document, "photo", "checked_by"), "person");
    assert_string_equal(item_text(document, "tamper", "answer"), "skipped");
    assert_string_equal(item_text(document, "tamper", "remark"), "not mounted yet");
    assert_int_equal(count_records(appliance), RECORDS);
    json_decref(document);
    appliance_expect(appliance_run(appliance, "log verify", NULL), 0);
    document = appliance_run_json(appliance, "log --event commission -n 1", NULL, 0);
    const json_t *last = json_array_get(json_object_get(document, "records"), 0);
    assert_string_equal(json_string_value(json_object_get(last, "reason")), "failed");
    assert_non_null(strstr(json_string_value(json_object_get(last, "note")), "for Ada Example"));
    json_decref(document);
    document = appliance_run_json(appliance, "log --event door-test -n 10", NULL, 0);
    assert_true(json_array_size(json_object_get(document, "records")) > 0);
    json_decref(document);
}

/* Under lockdown the relay is not switched. That is a fault, and so is the lockdown. */
static void a_relay_that_is_refused_is_a_fault(void **state)
{
    const struct appliance *appliance = *state;

    appliance_expect(appliance_run(appliance, "lockdown on", NULL), 0);
    json_t *document = appliance_run_json(appliance, command_with_answers(appliance, "tamper"),
                                          NULL, 4);
    appliance_expect(appliance_run(appliance, "lockdown off", NULL), 0);
    assert_string_equal(item_text(document, "relay", "answer"), "fault");
    assert_non_null(strstr(item_text(document, "relay", "remark"), "lockdown"));
    assert_string_equal(item_text(document, "service", "answer"), "fault");
    json_decref(document);
}

/* Runs the command at a terminal on which `typed` was typed ahead. Returns what it printed, to be
 * freed; *code is its exit code. */
static char *run_at_terminal(const struct appliance *appliance, const char *typed, int *code)
{
    char *text = NULL, bytes[512];
    size_t size;
    int master = -1, status = 0;
    ssize_t n;
    const pid_t child = forkpty(&master, NULL, NULL, NULL);

    assert_true(child >= 0);
    if (child == 0) {
        execl(appliance_isotherm, appliance_isotherm, "--bus", appliance->bus.address, "doctor",
              "--commission", (char *)NULL);
        _exit(127);
    }
    assert_int_equal(write(master, typed, strlen(typed)), strlen(typed));
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    while ((n = read(master, bytes, sizeof bytes)) > 0) { /* EIO at its end */
        (void)fwrite(bytes, 1, (size_t)n, out);
    }
    assert_int_equal(fclose(out), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    close(master);
    *code = child_code(status);
    return text;
}

static void a_person_answers_at_a_terminal(void **state)
{
    const struct appliance *appliance = *state;
    char typed[1024] = "Ada\tExample\nAda Example\n"; /* the first is no name */
    const size_t before = count_records(appliance);
    int code = 0;

    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        if (cli_checklist_asks(&cli_checklist[i])) {
            (void)strcat(typed, cli_checklist[i].way == CLI_WAY_RELAY ? "skip\nnot now\n" : "y\n");
        }
    }
    char *text = run_at_terminal(appliance, typed, &code);
    child_expect_code("doctor --commission", code, 4, text, "");
    assert_non_null(strstr(text, "Your name:"));
    assert_non_null(strstr(text, "the name holds a control character"));
    assert_non_null(strstr(text, "Does the exit button unlock the door? [y/n/skip]"));
    assert_non_null(strstr(text, "not now"));
    assert_non_null(strstr(text, "Outcome: failed; record "));
    assert_int_equal(count_records(appliance), before + RECORDS);
    free(text);
}

/* The character 4 at the begin of a line ends the input, as Ctrl-D does. */
static void an_interrupt_records_nothing(void **state)
{
    const struct appliance *appliance = *state;
    const size_t before = count_records(appliance);
    int code = 0;
    char *text = run_at_terminal(appliance, "Ada Example\n\x04", &code);

    child_expect_code("doctor --commission", code, 130, text, "");
    assert_non_null(strstr(text, "nothing has been recorded"));
    assert_int_equal(count_records(appliance), before);
    free(text);
}

static void without_a_daemon_it_says_so(void **state)
{
    struct appliance *appliance = *state;
    const char *command = command_with_answers(appliance, "tamper");

    appliance_end_daemon(appliance, SIGTERM);
    const struct appliance_result *result = appliance_run(appliance, command, NULL);
    appliance_expect(result, 4);
    assert_non_null(strstr(result->err, "isothermd is not running"));
    appliance_start_daemon(appliance);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_terminal_it_needs_answers),
        cmocka_unit_test(what_the_machine_finds_is_on_record),
        cmocka_unit_test(a_relay_that_is_refused_is_a_fault),
        cmocka_unit_test(a_person_answers_at_a_terminal),
        cmocka_unit_test(an_interrupt_records_nothing),
        cmocka_unit_test(without_a_daemon_it_says_so),
    };

    if (!appliance_find()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, appliance_setup, appliance_teardown);
}
