/* The files of board/cameras, read by the code with which the daemon reads [sensor] camera. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/recording/recording.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

#define CAMERAS ISOTHERM_SOURCE_DIR "/board/cameras/"

static char *read_text(const char *path)
{
    size_t size = 0;
    char *bytes = scratch_read(path, &size);
    char *text = calloc(size + 1, 1);
    assert_non_null(text);
    memcpy(text, bytes, size);
    free(bytes);
    return text;
}

static double degrees_across(double size_px, double focal_px)
{
    return 2.0 * atan(size_px / 2.0 / focal_px) * 180.0 / M_PI;
}

/* The figures must be possible for a camera that sees faces, and a comment must name their source.
 */
static void check_camera(const char *path)
{
    struct iso_recording_meta meta;
    struct iso_fault fault = {.text = ""};
    char *text = read_text(path);
    if (iso_recording_meta_parse(path, text, &meta, &fault)) {
        fail_msg("%s", fault.text);
    }
    const struct iso_camera *camera = &meta.camera;
    assert_true(meta.nominal);
    assert_true(camera->projection == ISO_PINHOLE);
    assert_near(camera->fx_px / camera->fy_px, 1.0, 0.01);
    assert_near(camera->cx_px, camera->width_px / 2.0, 0.03 * camera->width_px);
    assert_near(camera->cy_px, camera->height_px / 2.0, 0.03 * camera->height_px);
    const double wide = degrees_across(camera->width_px, camera->fx_px);
    assert_true(wide > 55.0 && wide < 85.0);
    assert_near(meta.unit_mm, 1.0, 0.0);
    assert_non_null(strstr(text, "# unit_mm: "));
    assert_true(strstr(text, "\n# fx_px, fy_px: ") ||
                strstr(text, "\n# All figures except the unit: "));
    free(text);
}

static void every_camera_is_read(void **state)
{
    glob_t files;
    (void)state;
    assert_int_equal(glob(CAMERAS "*.ini", 0, NULL, &files), 0);
    assert_int_equal(files.gl_pathc, 6);
    for (size_t i = 0; i < files.gl_pathc; i++) {
        check_camera(files.gl_pathv[i]);
    }
    globfree(&files);
}

/* The camera file that the configuration of a board names is one of board/cameras. */
static void a_board_names_a_camera_that_there_is(void **state)
{
    (void)state;
    char *text = read_text(ISOTHERM_SOURCE_DIR "/board/pc-usb/isotherm.conf");
    const char *named = strstr(text, "/usr/share/isotherm/cameras/");
    char path[512];
    assert_non_null(named);
    named += strlen("/usr/share/isotherm/cameras/");
    (void)snprintf(path, sizeof path, CAMERAS "%.*s", (int)strcspn(named, "\n"), named);
    check_camera(path);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_camera_is_read),
        cmocka_unit_test(a_board_names_a_camera_that_there_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
