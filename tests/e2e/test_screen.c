/* The screen beside a real daemon: what it shows of visits, of an enrolment, of a lockdown, and of
 * a daemon that is gone and comes back. It draws into a directory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/e2e/appliance.h"

enum { WAIT_MS = 20000, LOOK_MS = 50, MEMORY_KIB = 6 * 1024 };

static struct run screen;
static char log_path[256], pictures[256];
static long seen; /* how much of the log the test has taken */

/* Waits until the screen says this, after all that was waited for before. */
static void expect_scene(const char *text)
{
    static char log[65536];
    const struct timespec look = {.tv_nsec = LOOK_MS * 1000000L};
    for (int waited_ms = 0; waited_ms < WAIT_MS; waited_ms += LOOK_MS) {
        FILE *file = fopen(log_path, "r");
        assert_non_null(file);
        assert_int_equal(fseek(file, seen, SEEK_SET), 0);
        log[fread(log, 1, sizeof log - 1, file)] = '\0';
        (void)fclose(file);
        const char *found = strstr(log, text);
        if (found) {
            seen += found - log + (long)strlen(text);
            return;
        }
        (void)nanosleep(&look, NULL);
    }
    fail_msg("the screen did not show '%s', but after what was expected before: %s", text, log);
}

static int setup(void **state)
{
    if (appliance_setup(state)) {
        return -1;
    }
    struct appliance *appliance = *state;
    if (!appliance) {
        return 0;
    }
    /* A stored visit has three frames, after which the door says that it does not know the person.
     */
    appliance_end_daemon(appliance, SIGTERM);
    appliance->keys = "[decision]\nmax_frames = 3\n";
    appliance_configure(appliance);
    appliance_start_daemon(appliance);
    (void)snprintf(log_path, sizeof log_path, "%s/screen.log", appliance->directory);
    (void)snprintf(pictures, sizeof pictures, "%s/pictures", appliance->directory);
    const char *const argv[] = {ISOTHERM_BINARY_DIR "/enroll/screen/isotherm-screen",
                                "--bus",
                                appliance->bus.address,
                                "--png",
                                pictures,
                                "--verbose",
                                "--show-names",
                                NULL};
    FILE *log = fopen(log_path, "w");
    assert_non_null(log);
    (void)fclose(log);
    run_start_to(&screen, argv, log_path);
    return 0;
}

static int teardown(void **state)
{
    if (screen.pid) {
        (void)kill(screen.pid, SIGTERM);
        run_finish(&screen);
        run_free(&screen);
    }
    return appliance_teardown(state);
}

static void it_shows_an_enrolment(void **state)
{
    const struct appliance *appliance = *state;
    expect_scene("idle: ");
    appliance_expect(appliance_run(appliance, "enroll --quick p01", "p01-enrol"), 0);
    expect_scene("enrol: ");
    expect_scene("idle: ");
}

static void it_shows_who_is_let_in_and_who_is_not(void **state)
{
    const struct appliance *appliance = *state;
    const char *const visits[] = {"p01-v1", "p02-v1", NULL};
    /* p02 is not enrolled, which the command counts as a refusal of a probe: exit code 1. */
    appliance_expect(appliance_visit(appliance, visits), 1);
    expect_scene("allowed: Welcome");
    expect_scene("refused: Not recognised");
    expect_scene("idle: ");
}

static void it_shows_a_lockdown(void **state)
{
    const struct appliance *appliance = *state;
    appliance_expect(appliance_run(appliance, "lockdown on", NULL), 0);
    expect_scene("closed: Closed");
    appliance_expect(appliance_run(appliance, "lockdown off", NULL), 0);
    expect_scene("idle: ");
}

static void it_outlives_the_daemon(void **state)
{
    struct appliance *appliance = *state;
    appliance_end_daemon(appliance, SIGKILL);
    expect_scene("out-of-service: ");
    appliance_start_daemon(appliance);
    expect_scene("idle: ");
    appliance_expect(appliance_visit(appliance, (const char *const[]){"p01-v2", NULL}), 0);
    expect_scene("allowed: Welcome");
}

/* A number of smaps_rollup, KiB. */
static long memory_kib(const char *key)
{
    char path[64];
    char line[128];
    long kib = -1;
    (void)snprintf(path, sizeof path, "/proc/%d/smaps_rollup", (int)screen.pid);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (kib < 0 && fgets(line, sizeof line, file)) {
        if (strncmp(line, key, strlen(key)) == 0) {
            kib = strtol(line + strlen(key) + 1, NULL, 10);
        }
    }
    (void)fclose(file);
    assert_true(kib > 0);
    return kib;
}

/* What the program needs for itself; the rest are pages of libraries, which depend on the machine.
 * Sanitizers need more. */
static void it_needs_little_memory(void **state)
{
    (void)state;
    print_message("isotherm-screen: private %ld KiB, proportional %ld KiB\n",
                  memory_kib("Private_Dirty"), memory_kib("Pss"));
#ifndef ISOTHERM_SANITIZED
    assert_true(memory_kib("Private_Dirty") <= MEMORY_KIB);
#endif
    assert_int_equal(access(pictures, R_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_shows_an_enrolment),
        cmocka_unit_test(it_shows_who_is_let_in_and_who_is_not),
        cmocka_unit_test(it_shows_a_lockdown),
        cmocka_unit_test(it_needs_little_memory),
        cmocka_unit_test(it_outlives_the_daemon),
    };
    if (!appliance_find()) {
        return 77;
    }
    return cmocka_run_group_tests(tests, setup, teardown);
}
