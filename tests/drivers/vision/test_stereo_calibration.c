/* Calibration files of camera pairs, and the rectification that follows from them. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/stereo/rectification.h"
#include "tests/support/scratch.h"

/* All numbers differ, so that the test notices swapped keys. */
static struct iso_stereo_calibration sample_calibration(void)
{
    return (struct iso_stereo_calibration){
        .camera = {{.projection = ISO_PINHOLE,
                    .width_px = 640,
                    .height_px = 400,
                    .fx_px = 451.25,
                    .fy_px = 452.5,
                    .cx_px = 322.1,
                    .cy_px = 198.3,
                    .k1 = -0.11,
                    .k2 = 0.06,
                    .k3 = 0.001,
                    .p1 = 0.0006,
                    .p2 = -0.0004},
                   {.projection = ISO_PINHOLE,
                    .width_px = 640,
                    .height_px = 400,
                    .fx_px = 448.75,
                    .fy_px = 449.9,
                    .cx_px = 317.7,
                    .cy_px = 202.2,
                    .k1 = -0.10,
                    .k2 = 0.05,
                    .k3 = 0.002,
                    .p1 = -0.0003,
                    .p2 = 0.0005}},
        .right_from_left = {iso_mat3_rotation(iso_vec3(0.02, -0.05, 0.03)), {-58.0, 3.0, -5.0}},
        .pairs = 17,
        .rms_px = 0.125,
    };
}

static void writes_what_it_reads(void **state)
{
    const char *path = scratch_path(*state, "rig.ini");
    struct iso_stereo_calibration in = sample_calibration(), out;
    assert_int_equal(iso_stereo_calibration_write(path, &in, NULL), 0);
    assert_int_equal(iso_stereo_calibration_read(path, &out, NULL), 0);
    assert_memory_equal(&in.camera, &out.camera, sizeof in.camera);
    assert_int_equal(out.pairs, 17);
    assert_true(out.rms_px == 0.125);
    struct iso_vec3 a = in.right_from_left.translation_mm, b = out.right_from_left.translation_mm;
    assert_true(a.x == b.x && a.y == b.y && a.z == b.z);
    for (int i = 0; i < 9; i++) {
        double difference = in.right_from_left.rotation.m[i / 3][i % 3] -
                            out.right_from_left.rotation.m[i / 3][i % 3];
        assert_true(fabs(difference) < 1e-14);
    }
}

/* Returns the text of a valid file with one line replaced (or, with NULL, removed). Free it with
 * free(). */
static char *with_line(const char *directory, const char *line, const char *instead)
{
    const char *path = scratch_path(directory, "sound.ini");
    struct iso_stereo_calibration in = sample_calibration();
    size_t size;
    assert_int_equal(iso_stereo_calibration_write(path, &in, NULL), 0);
    char *sound = scratch_read(path, &size), *text = calloc(1, size + 512);
    assert_non_null(text);
    sound = realloc(sound, size + 1);
    assert_non_null(sound);
    sound[size] = '\0';
    const char *at = strstr(sound, line);
    assert_non_null(at);
    memcpy(text, sound, (size_t)(at - sound));
    strcat(text, instead ? instead : "");
    strcat(text, at + strlen(line));
    free(sound);
    return text;
}

static void refuses_what_it_does_not_understand(void **state)
{
    static const struct {
        const char *line, *instead, *complaint;
    } cases[] = {
        {"format = 1", "format = 2", "rig.ini: format 2 is not supported"},
        {"format = 1", "format = one", "rig.ini:2: bad value 'one' for format"},
        {"fx_px = 451.25\n", NULL, "rig.ini: fx_px is missing from [left]"},
        {"fx_px = 451.25", "fx_px = 451.25\nfx_px = 451.25", "fx_px is given twice in [left]"},
        {"fx_px = 451.25", "fx_px = nan", "bad value 'nan' for fx_px"},
        {"fx_px = 451.25", "focal = 1", "unknown key 'focal' in [left]"},
        {"fx_px = 451.25", "what is this", "not `key = value`"},
        {"[right]", "[middle]", "unknown key 'width_px' in [middle]"},
        {"tx_mm = -58", "tx_mm = 58", "the right camera stands at the left"},
        {"tx_mm = -58", "tx_mm = -5800", "the baseline must be 5..1000 mm"},
        {"ry_rad = -0.05", "ry_rad = -0.5", "more than 0.3 rad off the perpendicular"},
        {"width_px = 640", "width_px = 320", "the two images differ in size"},
        {"fx_px = 451.25", "fx_px = 551.25", "the focal lengths differ by more than 10 %"},
        {"fx_px = 451.25", "fx_px = 1", "focal length must be 16..65536 px"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text = with_line(*state, cases[i].line, cases[i].instead);
        struct iso_stereo_calibration out, before;
        struct iso_fault fault = {.text = ""};
        memset(&out, 0x5a, sizeof out);
        before = out;
        int error = iso_stereo_calibration_parse("rig.ini", text, &out, &fault);
        if (error != -EBADMSG || !strstr(fault.text, cases[i].complaint)) {
            fail_msg("'%s' gave %d, '%s'", cases[i].instead, error, fault.text);
        }
        assert_memory_equal(&out, &before, sizeof out);
        free(text);
    }
}

static void refuses_long_lines_and_missing_files(void **state)
{
    char text[400];
    struct iso_stereo_calibration out;
    struct iso_fault fault = {.text = ""};
    memset(text, ' ', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    assert_int_equal(iso_stereo_calibration_parse("x", text, &out, &fault), -EBADMSG);
    assert_string_equal(fault.text, "x:1: line too long");
    assert_int_equal(iso_stereo_calibration_read(scratch_path(*state, "none"), &out, &fault),
                     -ENOENT);
}

static void refuses_to_write_an_invalid_calibration(void **state)
{
    const char *path = scratch_path(*state, "rig.ini");
    struct iso_stereo_calibration bad = sample_calibration();
    struct iso_fault fault = {.text = ""};
    bad.right_from_left.rotation.m[0][0] = 2.0;
    assert_int_equal(iso_stereo_calibration_write(path, &bad, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "the rotation is none"));
    assert_false(scratch_exists(path));
    bad = sample_calibration();
    assert_int_equal(iso_stereo_calibration_write(scratch_path(*state, "no/rig.ini"), &bad, &fault),
                     -ENOENT);
    const char *link = scratch_path(*state, "full");
    assert_int_equal(symlink("/dev/full", link), 0);
    assert_int_equal(iso_stereo_calibration_write(link, &bad, &fault), -ENOSPC);
    assert_true(scratch_exists("/dev/full"));
}

/* A point is in the same row of both rectified images, f b / z columns apart (Fusiello, Trucco and
 * Verri 2000). The maps lead from there to the places at which the cameras see the point. */
static void rectified_rows_agree(void **state)
{
    (void)state;
    struct iso_stereo_calibration c = sample_calibration();
    struct iso_rectification r = iso_rectification_of(&c);
    size_t n = (size_t)r.camera.width_px * (size_t)r.camera.height_px;
    float *x[ISO_EYES], *y[ISO_EYES];
    assert_true(r.camera.fx_px == 451.0 && r.camera.fy_px == 451.0); /* 450.6, rounded */
    assert_true(fabs(r.baseline_mm - sqrt(58.0 * 58.0 + 9.0 + 25.0)) < 1e-12);
    for (int eye = 0; eye < ISO_EYES; eye++) {
        x[eye] = malloc(n * sizeof(float));
        y[eye] = malloc(n * sizeof(float));
        assert_true(x[eye] && y[eye]);
        iso_rectification_map(&r, &c, (enum iso_eye)eye, x[eye], y[eye]);
    }
    int points = 0;
    for (int column = 160; column < 600; column += 55) {
        for (int row = 20; row < 390; row += 37) {
            /* The disparity is a whole number, so that the right image is hit in a whole pixel,
             * too. */
            int disparity = 30 + (column + row) % 40;
            double z_mm = r.camera.fx_px * r.baseline_mm / disparity;
            struct iso_vec3 p = iso_camera_back_project(&r.camera, column, row, z_mm);
            struct iso_mat3 left_from_rectified = iso_mat3_transpose(&r.rectified_from_eye[0]);
            struct iso_vec3 left = iso_mat3_apply(&left_from_rectified, p);
            struct iso_vec3 right = iso_rigid_apply(&c.right_from_left, left);
            double u, v;
            size_t at = (size_t)row * 640 + (size_t)column;
            assert_true(iso_camera_project(&c.camera[ISO_EYE_LEFT], left, &u, &v));
            assert_true(fabs((double)x[0][at] - u) < 1e-4 && fabs((double)y[0][at] - v) < 1e-4);
            assert_true(iso_camera_project(&c.camera[ISO_EYE_RIGHT], right, &u, &v));
            at -= (size_t)disparity;
            assert_true(fabs((double)x[1][at] - u) < 1e-4 && fabs((double)y[1][at] - v) < 1e-4);
            points++;
        }
    }
    assert_int_equal(points, 8 * 10);
    for (int eye = 0; eye < ISO_EYES; eye++) {
        free(x[eye]);
        free(y[eye]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(writes_what_it_reads, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_what_it_does_not_understand, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_long_lines_and_missing_files, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_to_write_an_invalid_calibration, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(rectified_rows_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
