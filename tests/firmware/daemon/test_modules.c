/* The daemon with modules that exist, are missing or are broken. It runs on a copy of the library
 * in a directory of the test, because it looks for its modules beside the library. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define DAEMON  ISOTHERM_BINARY_DIR "/firmware/isothermd"
#define CLIENT  ISOTHERM_BINARY_DIR "/enroll/isotherm"
#define LIBRARY ISOTHERM_BINARY_DIR "/core/isotherm/libisotherm-core.so"
#define MODULES ISOTHERM_BINARY_DIR "/core/isotherm/"
#define DATA    ISOTHERM_SOURCE_DIR "/core/data"
#define NO_BUS  "unix:path=/nonexistent"

static void copy(const char *from, const char *to)
{
    size_t size = 0;
    void *bytes = scratch_read(from, &size);
    scratch_write(to, bytes, size);
    free(bytes);
}

static int setup(void **state)
{
    const int error = scratch_setup(state);
    const char *beside = scratch_path(*state, "isotherm");
    scratch_mkdir(beside);
    copy(LIBRARY, scratch_path(beside, "libisotherm-core.so"));
    return error ? error : setenv("LD_LIBRARY_PATH", beside, 1);
}

static int teardown(void **state)
{
    (void)unsetenv("LD_LIBRARY_PATH");
    return scratch_teardown(state);
}

static const char *module(const char *directory, const char *name)
{
    return scratch_path(scratch_path(directory, "isotherm"), name);
}

/* Copies a built module to its place. Skips the test if the module was not built. */
static void install(const char *directory, const char *name)
{
    char from[4096];
    (void)snprintf(from, sizeof from, MODULES "%s", name);
    if (!scratch_exists(from)) {
        print_message("%s is not built\n", name);
        skip();
    }
    copy(from, module(directory, name));
}

static const char *configuration(const char *directory, const char *bus, const char *more)
{
    static char text[2048];
    const char *path = scratch_path(directory, "c.conf");
    const char *path_of_replay = strstr(more, "[sensor]") ? "#" : "";
    (void)snprintf(text, sizeof text,
                   "[sensor]\n%spath = %s/slot\n"
                   "[gallery]\npath = %s/g.db\n[log]\npath = %s/a.log\n[bus]\naddress = %s\n"
                   "[model]\nhead = " DATA "/head.model\nmetric = " DATA "/face.metric\n%s\n",
                   path_of_replay, directory, directory, directory, bus, more);
    scratch_write_text(path, text);
    return path;
}

/* Runs the daemon. It ends with one line: before it has a bus, or because there is no bus. */
static void expect_end(const char *directory, const char *more, int exit, const char *line)
{
    const char *const argv[] = {DAEMON, "--config", configuration(directory, NO_BUS, more), NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    const char *newline = strchr(run.err, '\n');
    if (run.exit != exit || !strstr(run.err, line) || !newline || newline[1] != '\0') {
        fail_msg("exit %d, and said: %s", run.exit, run.err);
    }
    run_free(&run);
}

/* ---- a sensor ---- */

/* Whether the daemon prints this text when its configuration names a sensor. */
static bool says(const char *directory, const char *back_end, const char *words)
{
    char more[64];
    (void)snprintf(more, sizeof more, "[sensor]\nbackend = %s\n", back_end);
    const char *const argv[] = {DAEMON, "--config", configuration(directory, NO_BUS, more), NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    assert_true(run.err[0] != '\0');
    const bool said = strstr(run.err, words) != NULL;
    run_free(&run);
    return said;
}

static bool is_built_for(const char *directory, const char *back_end)
{
    return !says(directory, back_end, "no sensor '");
}

/* Whether the daemon reports no fault of a module. Other faults that keep it from starting do not
 * matter. */
static bool finds_its_modules(const char *directory, const char *back_end)
{
    return !says(directory, back_end, "the module ");
}

static void a_sensor_needs_its_module(void **state)
{
    char missing[4096];
    if (!is_built_for(*state, "v4l2-stereo")) {
        skip();
    }
    (void)snprintf(missing, sizeof missing,
                   "sensor v4l2-stereo: the module %s is missing: install the package "
                   "isotherm-stereo",
                   module(*state, "isotherm-stereo.so"));
    expect_end(*state, "[sensor]\nbackend = v4l2-stereo\n", 3, missing);

    scratch_write_text(module(*state, "isotherm-stereo.so"), "garbage\n");
    expect_end(*state, "[sensor]\nbackend = v4l2-stereo\n", 4,
               "/isotherm-stereo.so cannot be loaded: file too short");

    install(*state, "isotherm-stereo.so");
    assert_true(finds_its_modules(*state, "v4l2-stereo"));
}

static void a_counter_needs_its_module(void **state)
{
    static const char counter[] = "[seal]\ncounter = tpm2\ncounter_tcti = device:/nonexistent\n";
    install(*state, "isotherm-vision.so");
    expect_end(*state, counter, 3,
               "/isotherm-tpm2.so is missing: install the package isotherm-tpm2");
    install(*state, "isotherm-tpm2.so");
    expect_end(*state, counter, 4, "the TPM at device:/nonexistent: No such file or directory");
}

static void libcamera_needs_two_modules(void **state)
{
    if (!is_built_for(*state, "libcamera-stereo")) {
        skip();
    }
    install(*state, "isotherm-stereo.so");
    expect_end(*state, "[sensor]\nbackend = libcamera-stereo\n", 3,
               "/isotherm-libcamera.so is missing: install the package isotherm-libcamera");
    install(*state, "isotherm-libcamera.so");
    assert_true(finds_its_modules(*state, "libcamera-stereo"));
}

/* The check of the configuration refuses a missing module, as the start does. */
static void the_check_of_a_configuration_needs_the_modules(void **state)
{
    if (!is_built_for(*state, "libcamera-stereo")) {
        skip();
    }
    install(*state, "isotherm-stereo.so");
    const char *path = configuration(*state, NO_BUS, "[sensor]\nbackend = libcamera-stereo\n");
    const char *const argv[] = {DAEMON, "--check-config", "--config", path, NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    assert_int_equal(run.exit, 3);
    assert_non_null(strstr(run.err, "/isotherm-libcamera.so is missing: install the package"));
    assert_string_equal(run.out, "");
    run_free(&run);
}

/* ---- the image check ---- */

/* The module may be missing if the configuration names no cascade. A broken module is a fault,
 * unless the configuration switches the check off. */
static void a_named_cascade_needs_the_module(void **state)
{
    static const char cascade[] = "[recognition]\ncascade = " DATA "/head.model\n";
    expect_end(*state, "", 3, "bus '" NO_BUS "'");
    expect_end(*state, cascade, 3,
               "/isotherm-vision.so is missing: install the package isotherm-vision");
    scratch_write_text(module(*state, "isotherm-vision.so"), "garbage\n");
    expect_end(*state, "", 4, "/isotherm-vision.so cannot be loaded: file too short");
    expect_end(*state, "[recognition]\nintensity = off\n", 3, "bus '" NO_BUS "'");
    install(*state, "isotherm-vision.so");
    expect_end(*state, "", 3, "bus '" NO_BUS "'");
    expect_end(*state, cascade, 4, "/head.model: not a cascade that OpenCV can read");
}

/* Starts the daemon. Expects this word in its status, and this part of its line about the image
 * check (NULL: no such line). */
static void expect_image_check(const char *directory, const char *word, const char *line)
{
    struct private_bus bus;
    struct run run, status;
    char told[64];
    if (!private_bus_start(&bus)) {
        print_message("no dbus-daemon\n");
        skip();
    }
    const char *const argv[] = {DAEMON, "--config", configuration(directory, bus.address, ""),
                                NULL};
    const char *const ask[] = {CLIENT, "--bus", bus.address, "--json", "status", NULL};
    run_start(&run, argv);
    run_until(&run, "ready");
    run_start(&status, ask);
    run_finish(&status);
    assert_int_equal(kill(run.pid, SIGTERM), 0);
    run_finish(&run);
    private_bus_stop(&bus);
    (void)snprintf(told, sizeof told, "\"image-check\": \"%s\"", word);
    if (!strstr(status.out, told) ||
        (strstr(run.err, "images are not checked") != NULL) != !!line ||
        (line && !strstr(run.err, line))) {
        fail_msg("not %s: '%s' '%s'", told, status.out, run.err);
    }
    assert_int_equal(run.exit, 0);
    run_free(&status);
    run_free(&run);
}

static void without_its_module_the_check_is_absent(void **state)
{
    const char *const argv[] = {DAEMON, "--version", NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    assert_non_null(strstr(run.out, "image check: not installed\n"));
    run_free(&run);
    expect_image_check(*state, "absent", "images are not checked for faces: the module ");
    expect_image_check(*state, "absent",
                       "/isotherm-vision.so is missing: install the package isotherm-vision\n");
    install(*state, "isotherm-vision.so");
    expect_image_check(*state, "veto", NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_sensor_needs_its_module, setup, teardown),
        cmocka_unit_test_setup_teardown(a_counter_needs_its_module, setup, teardown),
        cmocka_unit_test_setup_teardown(libcamera_needs_two_modules, setup, teardown),
        cmocka_unit_test_setup_teardown(the_check_of_a_configuration_needs_the_modules, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(a_named_cascade_needs_the_module, setup, teardown),
        cmocka_unit_test_setup_teardown(without_its_module_the_check_is_absent, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
