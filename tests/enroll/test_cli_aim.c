/* isotherm aim shows the view of the sensor and one picture of it, against a scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/enroll/rigs/cli.h"
#include "tests/support/scratch.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void aim_shows_what_is_seen(void **state)
{
    static const struct fake_view views[] = {
        {"no-face", NAN, NAN},
        {"too-far", 1812.6, -12.4},
    };
    const struct fake_script script = {.views = views, .n_views = COUNT(views)};
    struct cli_result result = cli_run_interrupt(&script, "aim", "too-far");

    (void)state;
    cli_expect_exit(&result, 0);
    assert_non_null(strstr(result.out, "\nno-face               -     -     -    -     -    -"));
    assert_non_null(strstr(result.out, "  no face to be seen: stand in front of the camera\n"));
    assert_non_null(strstr(result.out, "\ntoo-far            1813     -     -  -12     -"));
    assert_non_null(strstr(result.out, "  come closer\n"));
    assert_string_equal(result.calls, "AimStart;AimStop"); /* no claim: the door stays in service */

    result = cli_run(&script, "aim --json --timeout 0.2");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out, "{\"capture\":\"no-face\"}\n"
                                    "{\"capture\":\"too-far\",\"distance-mm\":1812.5999999999999,"
                                    "\"yaw-deg\":-12.4}\n");
}

/* A silent camera is reported once. A camera that delivers frames is not reported. */
static void aim_says_that_no_frames_arrive(void **state)
{
    static const struct fake_view view = {"too-far", 1200, NAN};
    static const char says[] = "No frames arrive from the camera; isotherm doctor may say why.\n";
    const struct fake_script silent = {.n_views = 0}, works = {.views = &view, .n_views = 1};

    (void)state;
    struct cli_result result = cli_run(&silent, "aim --timeout 4.5");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.err, says);
    result = cli_run(&works, "aim --timeout 2.2");
    assert_string_equal(result.err, "");
}

/* All views fit, also those with numbers that no face has. */
static void aim_fits_80_columns(void **state)
{
    static const struct fake_view views[] = {
        {"no-face-in-image", 12345678.9, -123.4},
        {"too-few-points", 9999.4, NAN},
        {"look-down", 123456.7, 17},
    };
    const struct fake_script script = {.views = views, .n_views = COUNT(views)};
    struct cli_result result = cli_run_interrupt(&script, "aim", "look-down");
    size_t width = 0, lines = 0;

    (void)state;
    for (const char *c = result.out; *c; c++) {
        width = *c == '\n' ? 0 : width + 1;
        lines += *c == '\n';
        assert_true(width < 80);
    }
    assert_int_equal(lines, 7); /* the head line, and each view with its hint */
    assert_non_null(strstr(result.out, "\nno-face-in-image      >     -     - -123     -"));
}

static void aim_writes_a_picture(void **state)
{
    const struct fake_script script = {.picture = "PNG 123"};
    const char *path = scratch_path(*state, "seen.png");
    char words[256];
    struct stat status;
    size_t size = 0;

    scratch_write_text(path, "what was there before, and is longer");
    assert_int_equal(chmod(path, 0644), 0);
    (void)snprintf(words, sizeof words, "aim --picture %s", path);
    struct cli_result result = cli_run(&script, words);
    assert_int_equal(result.exit, 0);
    assert_non_null(strstr(result.out, path));
    assert_string_equal(result.calls, "Claim;Picture;Release");
    char *bytes = scratch_read(path, &size);
    assert_int_equal(size, 7);
    assert_memory_equal(bytes, "PNG 123", 7);
    free(bytes);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600); /* the file shows a person */

    (void)snprintf(words, sizeof words, "aim --json --picture %s", path);
    result = cli_run(&script, words);
    json_t *document = cli_json(&result);
    assert_int_equal(json_integer_value(json_object_get(document, "bytes")), 7);
    json_decref(document);
}

static void aim_says_why_there_is_no_picture(void **state)
{
    const struct fake_script denied = {.fail_method = "Picture",
                                       .fail_error = "org.freedesktop.DBus.Error.AccessDenied"};
    const struct fake_script blind = {.fail_method = "Picture",
                                      .fail_error = "org.isotherm.Error.DeviceFault"};
    const struct fake_script empty = {.picture = ""};
    const struct fake_script works = {.picture = "PNG"};
    const char *path = scratch_path(*state, "none.png");
    char words[256];

    (void)snprintf(words, sizeof words, "aim --picture %s", path);
    struct cli_result result = cli_run(&denied, words);
    assert_int_equal(result.exit, 1);
    assert_string_equal(result.calls, "Claim;Picture;Release");
    result = cli_run(&blind, words);
    assert_int_equal(result.exit, 4);
    assert_string_equal(result.calls, "Claim;Picture;Release");
    result = cli_run(&empty, words);
    assert_int_equal(result.exit, 4);
    assert_false(scratch_exists(path));
    result = cli_run(&works, "aim --picture /nowhere/seen.png");
    assert_int_equal(result.exit, 3);
    assert_non_null(strstr(result.err, "/nowhere/seen.png: No such file or directory"));
    result = cli_run(&works, "aim --picture /dev/full");
    assert_int_equal(result.exit, 4);
    assert_non_null(strstr(result.err, "/dev/full: No space left on device"));
    assert_true(scratch_exists("/dev/full"));
}

static void aim_ends_with_the_daemon(void **state)
{
    const struct fake_script script = {.vanish = true};
    const struct cli_result result = cli_run(&script, "aim");

    (void)state;
    cli_expect_exit(&result, 4);
    assert_non_null(strstr(result.err, "the daemon has gone away"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(aim_shows_what_is_seen),
        cmocka_unit_test(aim_says_that_no_frames_arrive),
        cmocka_unit_test(aim_fits_80_columns),
        cmocka_unit_test_setup_teardown(aim_writes_a_picture, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(aim_says_why_there_is_no_picture, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(aim_ends_with_the_daemon),
    };

    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}
