/* The fingerprint of the web server on the screen: which files are shown, and when they are read
 * again. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "enroll/screen/painter.h"
#include "tests/support/scratch.h"

static const char whole[] = "0A:1B:2C:3D:4E:5F:60:71:82:93:A4:B5:C6:D7:E8:F9:"
                            "01:12:23:34:45:56:67:78:89:9A:AB:BC:CD:DE:EF:F0";

/* What is shown of a file with these bytes. */
static const char *shown(const char *path, const char *bytes, size_t size)
{
    static struct screen_fingerprint fingerprint;
    fingerprint = (struct screen_fingerprint){.next_ns = 0};
    scratch_write(path, bytes, size);
    return screen_fingerprint_look(&fingerprint, path, 1);
}

static void a_fingerprint_is_shown_with_or_without_the_end_of_its_line(void **state)
{
    char line[sizeof whole + 1];
    const char *path = scratch_path(*state, "fingerprint");
    (void)snprintf(line, sizeof line, "%s\n", whole);
    assert_string_equal(shown(path, whole, strlen(whole)), whole);
    assert_string_equal(shown(path, line, strlen(line)), whole);
    assert_string_equal(shown(path, "F", 1), "F");
}

static void anything_else_is_shown_as_nothing(void **state)
{
    char longer[sizeof whole + 1];
    const char *path = scratch_path(*state, "fingerprint");
    (void)snprintf(longer, sizeof longer, "%s:", whole);
    assert_string_equal(shown(path, "", 0), "");
    assert_string_equal(shown(path, "\n", 1), "");
    assert_string_equal(shown(path, "ab:cd", 5), "");
    assert_string_equal(shown(path, "AB:CG", 5), "");
    assert_string_equal(shown(path, "AB CD", 5), "");
    assert_string_equal(shown(path, "AB\nCD", 5), "");
    assert_string_equal(shown(path, "AB\0CD", 5), "");
    assert_string_equal(shown(path, "AB\n\n", 4), "");
    assert_string_equal(shown(path, longer, strlen(longer)), "");
}

static void a_code_is_shown_and_nothing_else(void **state)
{
    const char *path = scratch_path(*state, "setup-code");
    struct screen_fingerprint code = {.next_ns = 0};
    scratch_write_text(path, "ABCDE-FGH12-MNPQR-STVWX\n");
    assert_string_equal(screen_setup_code_look(&code, path, 1), "ABCDE-FGH12-MNPQR-STVWX");
    scratch_write_text(path, "ABCDE FGH12");
    assert_string_equal(screen_setup_code_look(&code, path, 1 + SCREEN_FINGERPRINT_NS), "");
    assert_string_equal(screen_setup_code_look(&code, "", 1 + 2 * SCREEN_FINGERPRINT_NS), "");
}

static void a_file_that_is_no_file_is_shown_as_nothing(void **state)
{
    struct screen_fingerprint fingerprint = {.next_ns = 0};
    const char *path = scratch_path(*state, "fingerprint");
    const char *link = scratch_path(*state, "link");
    assert_string_equal(screen_fingerprint_look(&fingerprint, "", 1), "");
    assert_int_equal(fingerprint.next_ns, 0); /* nothing was read */
    assert_string_equal(screen_fingerprint_look(&fingerprint, path, 1), "");
    assert_int_equal(mkfifo(path, 0600), 0);
    fingerprint.next_ns = 0;
    assert_string_equal(screen_fingerprint_look(&fingerprint, path, 1), ""); /* and does not wait */
    assert_int_equal(unlink(path), 0);
    scratch_write_text(path, whole);
    assert_int_equal(symlink(path, link), 0);
    fingerprint.next_ns = 0;
    assert_string_equal(screen_fingerprint_look(&fingerprint, link, 1), "");
    assert_string_equal(screen_fingerprint_look(&fingerprint, *state, SCREEN_FINGERPRINT_NS + 1),
                        "");
}

static void the_file_is_read_again_every_ten_seconds(void **state)
{
    struct screen_fingerprint fingerprint = {.next_ns = 0};
    const char *path = scratch_path(*state, "fingerprint");
    const int64_t begin = 7;
    scratch_write_text(path, "AA:BB");
    assert_string_equal(screen_fingerprint_look(&fingerprint, path, begin), "AA:BB");
    scratch_write_text(path, "CC:DD");
    assert_string_equal(
        screen_fingerprint_look(&fingerprint, path, begin + SCREEN_FINGERPRINT_NS - 1), "AA:BB");
    assert_string_equal(screen_fingerprint_look(&fingerprint, path, begin + SCREEN_FINGERPRINT_NS),
                        "CC:DD");
    assert_int_equal(unlink(path), 0);
    assert_string_equal(
        screen_fingerprint_look(&fingerprint, path, begin + 2 * SCREEN_FINGERPRINT_NS), "");
}

/* ---- the painter ---- */

static cairo_surface_t *begin(void *self)
{
    return self;
}

static int show(void *self)
{
    (void)self;
    return 0;
}

/* A picture is drawn when the fingerprint has changed, and only in the idle scene. */
static void the_painter_shows_a_new_fingerprint(void **state)
{
    static const struct screen_display_ops ops = {.begin = begin, .show = show};
    const char *path = scratch_path(*state, "fingerprint");
    const char *code = scratch_path(*state, "setup-code");
    const struct screen_options options = {.language = "en",
                                           .place = "",
                                           .fingerprint = path,
                                           .setup_code = code,
                                           .width_px = 320,
                                           .height_px = 240};
    struct screen_state door = {.connected = true, .sees = true, .mode = "watch"};
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 320, 240);
    struct screen_painter painter = {.display = {&ops, surface}, .options = &options};

    screen_painter_paint(&painter, &door, 1, 0, false);
    assert_int_equal(painter.pictures, 1);
    assert_string_equal(painter.print, "");
    scratch_write_text(path, whole);
    screen_painter_paint(&painter, &door, 2, 0, false);
    assert_int_equal(painter.pictures, 1);
    screen_painter_paint(&painter, &door, 1 + SCREEN_FINGERPRINT_NS, 0, false);
    assert_int_equal(painter.pictures, 2);
    assert_string_equal(painter.print, whole);
    screen_painter_paint(&painter, &door, 2 + SCREEN_FINGERPRINT_NS, 0, false);
    assert_int_equal(painter.pictures, 2);
    door.lockdown = true;
    screen_painter_paint(&painter, &door, 3 + SCREEN_FINGERPRINT_NS, 0, false);
    assert_int_equal(painter.pictures, 3);
    assert_string_equal(painter.print, "");
    door.lockdown = false;
    scratch_write_text(code, "ABCDE-FGH12-MNPQR-STVWX");
    screen_painter_paint(&painter, &door, 2 + 2 * SCREEN_FINGERPRINT_NS, 0, false);
    assert_int_equal(painter.pictures, 4);
    assert_string_equal(painter.code, "ABCDE-FGH12-MNPQR-STVWX");
    assert_int_equal(unlink(code), 0);
    screen_painter_paint(&painter, &door, 2 + 3 * SCREEN_FINGERPRINT_NS, 0, false);
    assert_int_equal(painter.pictures, 5);
    assert_string_equal(painter.code, "");
    cairo_surface_destroy(surface);
}

int main(void)
{
#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(a_fingerprint_is_shown_with_or_without_the_end_of_its_line),
        IN_SCRATCH(anything_else_is_shown_as_nothing),
        IN_SCRATCH(a_code_is_shown_and_nothing_else),
        IN_SCRATCH(a_file_that_is_no_file_is_shown_as_nothing),
        IN_SCRATCH(the_file_is_read_again_every_ten_seconds),
        IN_SCRATCH(the_painter_shows_a_new_fingerprint),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
