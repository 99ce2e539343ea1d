/* recording.ini: the accepted values, and the fault line for all others. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "tests/support/stored_frames.h"

static void parses_a_pinhole(void **state)
{
    struct iso_recording_meta meta;
    (void)state;
    assert_int_equal(iso_recording_meta_parse("r", stored_ini, &meta, NULL), 0);
    assert_string_equal(meta.sensor, "astra");
    assert_int_equal(meta.camera.projection, ISO_PINHOLE);
    assert_int_equal(meta.camera.width_px, 7);
    assert_int_equal(meta.camera.height_px, 5);
    assert_true(meta.camera.fx_px == 570.5 && meta.camera.fy_px == 571.25);
    assert_true(meta.camera.cx_px == 3.5 && meta.camera.cy_px == 2.0);
    assert_true(meta.camera.k1 == -0.01 && meta.camera.k2 == 0.0 && meta.camera.p2 == 0.0);
    assert_true(meta.unit_mm == 0.5);
}

static void parses_an_orthographic(void **state)
{
    static const char text[] = "; Texas 3DFRD\r\n[recording]\r\nformat=1\r\nsensor=texas\r\n"
                               "[depth]\r\nprojection=orthographic\r\nwidth_px=501\r\n"
                               "height_px=751\r\npitch_mm=0.32\r\ncx_px=250\r\ncy_px=375\r\n"
                               "unit_mm=0.01\r\n";
    struct iso_recording_meta meta;
    (void)state;
    assert_int_equal(iso_recording_meta_parse("r", text, &meta, NULL), 0);
    assert_int_equal(meta.camera.projection, ISO_ORTHOGRAPHIC);
    assert_true(meta.camera.pitch_mm == 0.32);
}

/* Returns stored_ini with two changes, to be freed: `line` replaces the line that starts with `key`
 * ("" removes it, NULL keeps it), and `appended` is put at the end. */
static char *changed_ini(const char *key, const char *line, const char *appended)
{
    const char *at = key ? strstr(stored_ini, key) : stored_ini;
    char *text = malloc(strlen(stored_ini) + 1024);
    assert_non_null(text);
    assert_non_null(at);
    const char *rest = key ? strchr(at, '\n') + 1 : at;
    (void)sprintf(text, "%.*s%s%s%s", (int)(at - stored_ini), stored_ini, line ? line : "", rest,
                  appended ? appended : "");
    return text;
}

static void assert_refused(const char *key, const char *line, const char *appended,
                           const char *expected)
{
    struct iso_recording_meta meta, untouched;
    struct iso_fault fault = {.text = ""};
    char *text = changed_ini(key, line, appended);
    memset(&meta, 0x5a, sizeof meta);
    untouched = meta;
    assert_int_equal(iso_recording_meta_parse("a/recording.ini", text, &meta, &fault), -EBADMSG);
    assert_string_equal(fault.text, expected);
    assert_memory_equal(&meta, &untouched, sizeof meta);
    free(text);
}

static void refuses_the_unknown(void **state)
{
    (void)state;
    assert_refused(NULL, NULL, "gain = 3\n", "a/recording.ini:15: unknown key 'gain' in [depth]");
    assert_refused(NULL, NULL, "[audio]\nrate = 3\n",
                   "a/recording.ini:16: unknown key 'rate' in [audio]");
    assert_refused(NULL, "fx_px = 1\n", NULL, "a/recording.ini:1: unknown key 'fx_px' in []");
    assert_refused("format", "format = 2\n", NULL, "a/recording.ini: format 2 is not supported");
    assert_refused("projection", "projection = fisheye\n", NULL,
                   "a/recording.ini:6: bad value 'fisheye' for projection");
    assert_refused(NULL, NULL, "nonsense\n", "a/recording.ini:15: not `key = value`");
    assert_refused(NULL, NULL, "[depth\n", "a/recording.ini:15: not `key = value`");
}

static void refuses_the_missing_and_the_repeated(void **state)
{
    static const char *const keys[] = {"format", "sensor", "projection", "width_px", "height_px",
                                       "fx_px",  "fy_px",  "cx_px",      "cy_px",    "unit_mm"};
    (void)state;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        char expected[128];
        (void)snprintf(expected, sizeof expected, "a/recording.ini: %s is missing from [%s]",
                       keys[i], i < 2 ? "recording" : "depth");
        assert_refused(keys[i], "", NULL, expected);
    }
    assert_refused(NULL, NULL, "cx_px = 3.5\n",
                   "a/recording.ini:15: cx_px is given twice in [depth]");
}

static void refuses_keys_of_the_other_projection(void **state)
{
    (void)state;
    assert_refused(NULL, NULL, "pitch_mm = 0.3\n",
                   "a/recording.ini: pitch_mm does not belong to this projection");
    assert_refused("projection", "projection = orthographic\npitch_mm = 0.3\n", NULL,
                   "a/recording.ini: fx_px does not belong to this projection");
}

static void refuses_bad_numbers(void **state)
{
    (void)state;
    assert_refused("fx_px", "fx_px = nan\n", NULL, "a/recording.ini:9: bad value 'nan' for fx_px");
    assert_refused("cy_px", "cy_px = inf\n", NULL, "a/recording.ini:12: bad value 'inf' for cy_px");
    assert_refused("k1", "k1 =\n", NULL, "a/recording.ini:13: bad value '' for k1");
    assert_refused("width_px", "width_px = -7\n", NULL,
                   "a/recording.ini:7: bad value '-7' for width_px");
    assert_refused("width_px", "width_px = 7.0\n", NULL,
                   "a/recording.ini:7: bad value '7.0' for width_px");
    assert_refused("width_px", "width_px = 4294967303\n", NULL,
                   "a/recording.ini:7: bad value '4294967303' for width_px");
    assert_refused("sensor", "sensor = two words\n", NULL,
                   "a/recording.ini:3: bad value 'two words' for sensor");
    assert_refused("sensor", "sensor = a2345678901234567890123456789012\n", NULL,
                   "a/recording.ini:3: bad value 'a2345678901234567890123456789012' for sensor");
}

/* Other tests cover the checks of the camera. This test only shows that the reader calls them. */
static void refuses_absurd_cameras(void **state)
{
    static const char *const lines[][2] = {
        {"width_px", "width_px = 0\n"},  {"height_px", "height_px = 99999\n"},
        {"fx_px", "fx_px = -570\n"},     {"fy_px", "fy_px = 1e30\n"},
        {"cx_px", "cx_px = 1e6\n"},      {"k1", "k1 = 1e9\n"},
        {"unit_mm", "unit_mm = 0\n"},    {"unit_mm", "unit_mm = -1\n"},
        {"unit_mm", "unit_mm = 1000\n"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        struct iso_recording_meta meta;
        struct iso_fault fault = {.text = ""};
        char *text = changed_ini(lines[i][0], lines[i][1], NULL);
        assert_int_equal(iso_recording_meta_parse("r.ini", text, &meta, &fault), -EBADMSG);
        assert_int_equal(strncmp(fault.text, "r.ini: ", 7), 0);
        assert_true(strlen(fault.text) > 12);
        free(text);
    }
}

static void refuses_lines_that_would_be_cut(void **state)
{
    char line[300];
    (void)state;
    (void)snprintf(line, sizeof line, "cx_px = %0200d\n", 7);
    assert_refused("cx_px", line, NULL, "a/recording.ini:11: line too long");
}

static void checks_what_would_be_written(void **state)
{
    struct iso_recording_meta meta;
    struct iso_fault what = {.text = ""};
    (void)state;
    assert_int_equal(iso_recording_meta_parse("r", stored_ini, &meta, NULL), 0);
    assert_int_equal(iso_recording_meta_check(&meta, &what), 0);
    meta.unit_mm = 0.0;
    assert_int_equal(iso_recording_meta_check(&meta, &what), -EINVAL);
    assert_non_null(strstr(what.text, "unit_mm"));
    meta.unit_mm = 1.0;
    memset(meta.sensor, 'x', sizeof meta.sensor); /* it has no end */
    assert_int_equal(iso_recording_meta_check(&meta, NULL), -EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parses_a_pinhole),
        cmocka_unit_test(parses_an_orthographic),
        cmocka_unit_test(refuses_the_unknown),
        cmocka_unit_test(refuses_the_missing_and_the_repeated),
        cmocka_unit_test(refuses_keys_of_the_other_projection),
        cmocka_unit_test(refuses_bad_numbers),
        cmocka_unit_test(refuses_absurd_cameras),
        cmocka_unit_test(refuses_lines_that_would_be_cut),
        cmocka_unit_test(checks_what_would_be_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
