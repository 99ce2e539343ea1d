/* `isotherm doctor` on a running daemon: everything that keeps people out is a finding with a
 * remedy. Each test continues from the state that the test before it leaves. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "enroll/cli/doctor/remedy.h"
#include "tests/e2e/appliance.h"
#include "tests/support/scratch.h"

/* Runs the doctor, and expects a finding of this subject with this state, with these words in its
 * text, with this code and with the remedy of the code. ISO_FAULT_NONE: with neither. */
static void expect_finding(const struct appliance *appliance, int exit, const char *subject,
                           const char *state, const char *words, enum iso_fault_code code)
{
    json_t *document = appliance_run_json(appliance, "doctor", NULL, exit);
    const json_t *check = NULL;
    size_t i;

    json_array_foreach(json_object_get(document, "checks"), i, check)
    {
        if (strcmp(json_string_value(json_object_get(check, "subject")), subject) == 0) {
            break;
        }
    }
    assert_non_null(check);
    const char *found = json_string_value(json_object_get(check, "found"));
    const char *name = json_string_value(json_object_get(check, "code"));
    const char *told = json_string_value(json_object_get(check, "remedy"));
    if (strcmp(json_string_value(json_object_get(check, "state")), state) != 0 ||
        !strstr(found, words) || strcmp(name ? name : "none", iso_fault_code_name(code)) != 0 ||
        strcmp(told ? told : "", cli_remedy(code) ? cli_remedy(code) : "") != 0) {
        fail_msg("%s: %s [%s] -> %s", subject, found, name ? name : "none",
                 told ? told : "(no remedy)");
    }
    assert_int_equal(json_is_true(json_object_get(document, "healthy")), exit == 0);
    json_decref(document);
}

static void a_replay_of_nothing_is_found(void **state)
{
    expect_finding(*state, 0, "sensor", "warning",
                   "started: there is no recording at its path, and no frame has arrived yet",
                   ISO_FAULT_RECORDING_MISSING);
}

static void an_empty_gallery_is_found(void **state)
{
    expect_finding(*state, 0, "gallery", "warning", "0 people", ISO_FAULT_GALLERY_EMPTY);
}

static void people_whose_time_has_not_come_are_found(void **state)
{
    assert_int_equal(
        appliance_run(*state, "enroll --quick p01 --valid-from 2037-01-01", "p01-enrol")->exit, 0);
    expect_finding(*state, 4, "gallery", "fault", "1 people, none of whom is valid at this time",
                   ISO_FAULT_NOBODY_VALID);
    assert_int_equal(appliance_run(*state, "enroll --quick p02", "p02-enrol")->exit, 0);
    expect_finding(*state, 0, "gallery", "ok", "2 people", ISO_FAULT_NONE);
}

static void a_lockdown_is_found(void **state)
{
    assert_int_equal(appliance_run(*state, "lockdown on", NULL)->exit, 0);
    expect_finding(*state, 4, "service", "fault", "lockdown: the door admits nobody",
                   ISO_FAULT_LOCKDOWN);
    assert_int_equal(appliance_run(*state, "lockdown off", NULL)->exit, 0);
    expect_finding(*state, 0, "door", "ok", "locked", ISO_FAULT_NONE);
}

static void a_lockout_is_found(void **state)
{
    const char *const strangers[] = {"x01-v1", "x02-v1", "x03-v1", "x04-v1",
                                     "x05-v1", "x06-v1", "x07-v1", NULL};

    assert_int_equal(appliance_visit(*state, strangers)->exit, 0);
    expect_finding(*state, 4, "service", "fault", "locked out: the door admits nobody for another ",
                   ISO_FAULT_LOCKED_OUT);
    assert_int_equal(appliance_run(*state, "lockout clear", NULL)->exit, 0);
    expect_finding(*state, 0, "door", "ok", "locked", ISO_FAULT_NONE);
}

/* This is the only call that switches the relay. Without a terminal the tool cannot ask for a
 * confirmation and refuses. */
static void the_relay_is_tested_on_record(void **state)
{
    const struct appliance_result *result = appliance_run(*state, "door test", NULL);

    assert_int_equal(result->exit, 2);
    assert_non_null(strstr(result->err, "confirm with --yes"));
    assert_int_equal(appliance_run(*state, "door open --yes", NULL)->exit, 2);
    assert_null(strstr(appliance_run(*state, "log --json -n 3", NULL)->out, "door-test"));
    result = appliance_run(*state, "door test --yes", NULL);
    assert_int_equal(result->exit, 0);
    assert_non_null(strstr(result->out, "The relay was switched"));
    result = appliance_run(*state, "log --json -n 4", NULL);
    const char *before = strstr(result->out, "door-test"), *relay = strstr(result->out, "unlocked");
    assert_true(before && relay && before < relay);
    assert_int_equal(appliance_run(*state, "lockdown on", NULL)->exit, 0);
    result = appliance_run(*state, "door test --yes", NULL);
    assert_int_not_equal(result->exit, 0);
    assert_non_null(strstr(result->err, "lockdown: nobody is let in"));
    assert_int_equal(appliance_run(*state, "lockdown off", NULL)->exit, 0);
}

/* ---- real faults of the disk, the stores and the lines ---- */

/* A limit forbids the daemon to let a file grow, as on a full disk. */
static void a_full_disk_is_found(void **state)
{
    struct appliance *appliance = *state;
    const struct rlimit full = {.rlim_cur = 1, .rlim_max = RLIM_INFINITY};
    const struct rlimit room = {.rlim_cur = RLIM_INFINITY, .rlim_max = RLIM_INFINITY};
    assert_int_equal(prlimit(appliance->daemon.pid, RLIMIT_FSIZE, &full, NULL), 0);
    const struct appliance_result *result = appliance_run(appliance, "remove p02", NULL);
    assert_int_equal(result->exit, 4);
    expect_finding(appliance, 4, "disk", "fault", "the disk refused", ISO_FAULT_DISK_FULL);
    assert_int_equal(prlimit(appliance->daemon.pid, RLIMIT_FSIZE, &room, NULL), 0);
    assert_int_equal(appliance_run(appliance, "remove p02", NULL)->exit, 0);
    expect_finding(appliance, 4, "gallery", "fault", "1 people, none of whom",
                   ISO_FAULT_NOBODY_VALID);
}

/* Starts the daemon again. Its configuration has `after` in place of the first `before`. */
static void restart_with(struct appliance *appliance, const char *before, const char *after)
{
    size_t size;
    appliance_end_daemon(appliance, SIGTERM);
    appliance_configure(appliance);
    char *bytes = scratch_read(appliance->configuration, &size);
    char *text = strndup(bytes, size), *at = strstr(text, before), *changed = NULL;
    assert_non_null(at);
    assert_true(asprintf(&changed, "%.*s%s%s", (int)(at - text), text, after, at + strlen(before)) >
                0);
    scratch_write_text(appliance->configuration, changed);
    free(changed);
    free(text);
    free(bytes);
    appliance_start_daemon(appliance);
}

static void lines_that_do_not_work_are_found(void **state)
{
    struct appliance *appliance = *state;
    restart_with(appliance, "backend = null", "backend = gpiod\nrelay = gpiochip4711:17");
    expect_finding(appliance, 4, "lines", "fault", "no such GPIO chip", ISO_FAULT_CHIP_MISSING);
    expect_finding(appliance, 4, "door", "fault", "fault", ISO_FAULT_DOOR_AT_FAULT);
    assert_int_equal(access("/dev/gpiochip4711", F_OK), -1);
}

static void a_damaged_recording_is_found(void **state)
{
    struct appliance *appliance = *state;
    char path[256];
    restart_with(appliance, "backend = null", "backend = null");
    (void)snprintf(path, sizeof path, "%s/slot", appliance->directory);
    (void)unlink(path);
    assert_int_equal(mkdir(path, 0700), 0);
    appliance_end_daemon(appliance, SIGTERM);
    appliance_start_daemon(appliance);
    assert_non_null(appliance);
    appliance_end_daemon(appliance, SIGTERM);
    assert_non_null(strstr(appliance->daemon.err, "[file-missing]")); /* it has no recording.ini */
    assert_int_equal(rmdir(path), 0);
    appliance_start_daemon(appliance);
}

/* The file was deleted, and the other stores know that it existed. */
static void a_lockout_file_that_is_missing_is_found(void **state)
{
    struct appliance *appliance = *state;
    char path[256];
    appliance_end_daemon(appliance, SIGTERM);
    (void)snprintf(path, sizeof path, "%s/lockout", appliance->directory);
    assert_int_equal(unlink(path), 0);
    appliance_start_daemon(appliance);
    expect_finding(appliance, 4, "service", "fault", "lockdown: the door admits nobody",
                   ISO_FAULT_LOCKDOWN);
    appliance_end_daemon(appliance, SIGTERM);
    assert_non_null(strstr(appliance->daemon.err, "[lockout-missing]"));
    appliance_start_daemon(appliance);
}

/* ---- states in which the daemon does not start ---- */

/* Starts another daemon with the same files. It must end with a fault that has this code. */
static void expect_refusal(const struct appliance *appliance, const char *tag)
{
    const char *const argv[] = {ISOTHERM_BINARY_DIR "/firmware/isothermd", "--config",
                                appliance->configuration, NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    if (run.exit == 0 || !strstr(run.err, tag)) {
        fail_msg("not %s: %s", tag, run.err);
    }
    run_free(&run);
}

static void two_daemons_do_not_share_their_files(void **state)
{
    expect_refusal(*state, "[store-busy]");
}

static void a_gallery_that_is_gone_is_missed(void **state)
{
    struct appliance *appliance = *state;
    char path[256], away[256];
    appliance_end_daemon(appliance, SIGTERM);
    (void)snprintf(path, sizeof path, "%s/gallery.db", appliance->directory);
    (void)snprintf(away, sizeof away, "%s/away", appliance->directory);
    assert_int_equal(rename(path, away), 0);
    expect_refusal(appliance, "[gallery-missing]");
    assert_int_equal(rename(away, path), 0);
    appliance_start_daemon(appliance);
}

static void a_log_of_an_earlier_time_is_refused(void **state)
{
    struct appliance *appliance = *state;
    char path[256];
    size_t old_size, new_size;
    (void)snprintf(path, sizeof path, "%s/audit.log", appliance->directory);
    appliance_end_daemon(appliance, SIGTERM);
    char *old = scratch_read(path, &old_size);
    appliance_start_daemon(appliance);
    appliance_end_daemon(appliance, SIGTERM);
    char *new = scratch_read(path, &new_size);
    assert_true(new_size > old_size);
    scratch_write(path, old, old_size);
    expect_refusal(appliance, "[log-old]");
    scratch_write(path, new, new_size);
    free(new);
    free(old);
    appliance_start_daemon(appliance);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_replay_of_nothing_is_found),
        cmocka_unit_test(an_empty_gallery_is_found),
        cmocka_unit_test(people_whose_time_has_not_come_are_found),
        cmocka_unit_test(a_lockdown_is_found),
        cmocka_unit_test(a_lockout_is_found),
        cmocka_unit_test(the_relay_is_tested_on_record),
        cmocka_unit_test(a_full_disk_is_found),
        cmocka_unit_test(lines_that_do_not_work_are_found),
        cmocka_unit_test(a_damaged_recording_is_found),
        cmocka_unit_test(a_lockout_file_that_is_missing_is_found),
        cmocka_unit_test(two_daemons_do_not_share_their_files),
        cmocka_unit_test(a_gallery_that_is_gone_is_missed),
        cmocka_unit_test(a_log_of_an_earlier_time_is_refused),
    };

    if (!appliance_find()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, appliance_setup, appliance_teardown);
}
