/* Real faults that keep the daemon from starting. The daemon's line ends with the code of the
 * fault. Each test has a directory of its own. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/base/fault_code.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define PROGRAM ISOTHERM_BINARY_DIR "/firmware/isothermd"
#define DATA    ISOTHERM_SOURCE_DIR "/core/data"

/* Writes a configuration that would work, but has no bus. `more` is part of it. Returns its path.
 */
static const char *write_configuration(const char *directory, const char *more)
{
    static char text[2048];
    const char *path = scratch_path(directory, "c.conf");
    (void)snprintf(text, sizeof text,
                   "[sensor]\npath = %s/slot\n"
                   "[gallery]\npath = %s/g.db\n[log]\npath = %s/a.log\nsync = no\n"
                   "[bus]\naddress = unix:path=/nonexistent\n"
                   "[model]\nhead = " DATA "/head.model\nmetric = " DATA "/face.metric\n%s\n"
                   "[process]\nconfine = no\n",
                   directory, directory, directory, more);
    scratch_write_text(path, text);
    return path;
}

/* Runs the program until it ends. `option` may be NULL. The program opens its stores, and it ends
 * at the missing bus at the latest. */
static void expect_code(const char *configuration, const char *option, enum iso_fault_code code)
{
    const char *const argv[] = {PROGRAM, "--config", configuration, option, NULL};
    struct run run;
    char tag[64];
    run_start(&run, argv);
    run_finish(&run);
    (void)snprintf(tag, sizeof tag, " [%s]\n", iso_fault_code_name(code));
    const size_t length = strlen(run.err);
    if (length < strlen(tag) || strcmp(run.err + length - strlen(tag), tag) != 0) {
        fail_msg("no '%s' at the end of: %s", iso_fault_code_name(code), run.err);
    }
    assert_int_not_equal(run.exit, 0);
    run_free(&run);
}

static void a_wrong_configuration(void **state)
{
    const char *const directory = *state;
    expect_code("/nonexistent/c.conf", NULL, ISO_FAULT_NOT_CONFIGURED);
    expect_code(write_configuration(directory, "[door]\ncolour = 1"), NULL, ISO_FAULT_CONFIG_WRONG);
    expect_code(write_configuration(directory, "[door]\nbackend = gate"), NULL,
                ISO_FAULT_DRIVER_UNKNOWN);
    expect_code(write_configuration(directory, ""), NULL, ISO_FAULT_BUS_MISSING);
}

static void a_missing_door(void **state)
{
    const char *path = write_configuration(*state, "[door]\nbackend = gpiod\n"
                                                   "relay = gpiochip4711:17");
    const char *const argv[] = {PROGRAM, "--config", path, "--rest-door", NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    const bool built = !strstr(run.err, "[driver-unknown]");
    run_free(&run);
    if (!built) {
        print_message("built without libgpiod\n");
        skip();
    }
    expect_code(path, "--rest-door", ISO_FAULT_CHIP_MISSING);
    expect_code(write_configuration(*state, "[door]\nbackend = gpiod"), "--rest-door",
                ISO_FAULT_OPTION_WRONG);
}

static void files_that_cannot_be_used(void **state)
{
    char text[1024];
    const char *path = scratch_path(*state, "d.conf");
    scratch_write_text(path, "[model]\nhead = /nonexistent/head.model\n");
    expect_code(path, NULL, ISO_FAULT_FILE_MISSING);
    (void)snprintf(text, sizeof text, "[model]\nhead = %s\n", (const char *)*state);
    scratch_write_text(path, text);
    expect_code(path, NULL, ISO_FAULT_FILE_UNFIT);
    scratch_write_text(path, "[model]\nhead = " DATA "/cohort.templates\n");
    expect_code(path, NULL, ISO_FAULT_MODEL_DAMAGED);
    (void)snprintf(text, sizeof text,
                   "[model]\nhead = " DATA "/head.model\nmetric = " DATA "/head.model\n");
    scratch_write_text(path, text);
    expect_code(path, NULL, ISO_FAULT_MODEL_DAMAGED);
    if (geteuid() != 0) { /* root may read every file */
        const char *hidden = scratch_path(*state, "hidden.model");
        scratch_write_text(hidden, "x");
        assert_int_equal(chmod(hidden, 0), 0);
        (void)snprintf(text, sizeof text, "[model]\nhead = %s\n", hidden);
        scratch_write_text(path, text);
        expect_code(path, NULL, ISO_FAULT_FILE_DENIED);
    }
}

static void a_damaged_gallery(void **state)
{
    const char *path = write_configuration(*state, "");
    scratch_write_text(scratch_path(*state, "g.db"), "");
    expect_code(path, NULL, ISO_FAULT_GALLERY_DAMAGED);
}

static void a_damaged_log(void **state)
{
    const char *path = write_configuration(*state, ""), *log = scratch_path(*state, "a.log");
    char anchor[512];
    expect_code(path, NULL, ISO_FAULT_BUS_MISSING); /* this start creates the stores */
    scratch_write_text(log, "nonsense\n");
    expect_code(path, NULL, ISO_FAULT_LOG_DAMAGED);
    (void)snprintf(anchor, sizeof anchor, "%s.anchor", log);
    scratch_write_text(anchor, "nonsense\n");
    expect_code(path, NULL, ISO_FAULT_ANCHOR_DAMAGED);
    assert_int_equal(unlink(anchor), 0);
    expect_code(path, NULL, ISO_FAULT_ANCHOR_DAMAGED);
}

static void a_missing_or_wrong_key(void **state)
{
    const char *path = write_configuration(*state, ""), *key = scratch_path(*state, "g.db.key");
    expect_code(path, NULL, ISO_FAULT_BUS_MISSING);
    scratch_write_text(key, "0123456789abcdef0123456789abcdef");
    assert_int_equal(chmod(key, 0644), 0);
    expect_code(path, NULL, ISO_FAULT_KEY_EXPOSED);
    assert_int_equal(chmod(key, 0600), 0);
    expect_code(path, NULL, ISO_FAULT_KEY_WRONG);
    assert_int_equal(unlink(key), 0);
    expect_code(path, NULL, ISO_FAULT_KEY_MISSING);
}

/* The size of files is limited, so that the daemon finds no room on the disk. */
static void a_full_disk(void **state)
{
    const struct rlimit full = {.rlim_cur = 16, .rlim_max = RLIM_INFINITY};
    const struct rlimit room = {.rlim_cur = RLIM_INFINITY, .rlim_max = RLIM_INFINITY};
    const char *path = write_configuration(*state, "");
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &full), 0);
    expect_code(path, NULL, ISO_FAULT_DISK_FULL);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &room), 0);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_wrong_configuration), TEST(a_missing_door), TEST(files_that_cannot_be_used),
        TEST(a_damaged_gallery),     TEST(a_damaged_log),  TEST(a_missing_or_wrong_key),
        TEST(a_full_disk),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
