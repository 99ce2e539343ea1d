/* The lens of one camera from rendered pictures of a board. A known lens is found again, and
 * pictures that cannot determine a lens are refused. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/file/png.h"
#include "drivers/recording/recording.h"
#include "sim/world/stereo/board_picture.h"
#include "sim/world/stereo/lens_calibration.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

enum { WIDTH = 640, HEIGHT = 480 };

static const struct iso_board board = {9, 6, 20.0};

/* A lens with much radial distortion, off its centre. */
static const struct iso_camera truth = {
    .projection = ISO_PINHOLE,
    .width_px = WIDTH,
    .height_px = HEIGHT,
    .fx_px = 512.3,
    .fy_px = 515.1,
    .cx_px = 327.4,
    .cy_px = 231.8,
    .k1 = -0.22,
    .k2 = 0.07,
    .p1 = 0.0006,
    .p2 = -0.0009,
};

enum movement { ALL_OVER, NEVER_TURNED, IN_THE_MIDDLE, THE_SAME };

static struct iso_rigid pose_of(enum movement movement, struct sim_random *random)
{
    const struct iso_stereo_calibration rig = {.camera = {truth, truth}};
    struct sim_random fixed = sim_random_seeded(3, 0, 0);
    struct iso_rigid pose = sim_board_pose(&rig, &board, movement == THE_SAME ? &fixed : random);
    const struct iso_vec3 middle = {80.0, 50.0, 0.0};
    if (movement == NEVER_TURNED) {
        struct iso_vec3 at = iso_rigid_apply(&pose, middle);
        pose.rotation = iso_mat3_rotation(iso_vec3(0.1, 0.1, 0.0));
        pose.translation_mm = iso_sub(at, iso_mat3_apply(&pose.rotation, middle));
    }
    if (movement == IN_THE_MIDDLE) {
        const struct iso_vec3 at = {sim_random_between(random, -30.0, 30.0), 0.0, 450.0};
        pose.translation_mm = iso_sub(at, iso_mat3_apply(&pose.rotation, middle));
    }
    return pose;
}

/* Writes pictures 000.png, ... to a folder of the directory. */
static const char *take(const char *directory, enum movement movement, int n, bool colour)
{
    static uint8_t grey[WIDTH * HEIGHT], rgb[3 * WIDTH * HEIGHT];
    const char *folder = scratch_path(directory, "pictures");
    struct sim_lens *lens = NULL;
    assert_int_equal(sim_lens_new(&truth, &lens), 0);
    scratch_mkdir(folder);
    for (int i = 0; i < n; i++) {
        char name[32];
        struct sim_random random = sim_random_seeded(11, 0, (uint64_t)i);
        struct iso_rigid pose = pose_of(movement, &random);
        struct iso_image image = {.width_px = WIDTH,
                                  .height_px = HEIGHT,
                                  .pixel = colour ? ISO_PIXEL_RGB8 : ISO_PIXEL_GREY8,
                                  .samples = colour ? rgb : grey};
        sim_board_picture(&board, lens, &pose, 2.0, &random, grey);
        for (size_t k = 0; colour && k < sizeof rgb; k++) {
            rgb[k] = grey[k / 3];
        }
        (void)snprintf(name, sizeof name, "%03d.png", i);
        assert_int_equal(iso_png_write(scratch_path(folder, name), &image, 1, NULL), 0);
    }
    sim_lens_free(lens);
    return folder;
}

static int calibrate(const char *directory, const char *pictures, struct iso_fault *fault)
{
    const struct sim_lens_calibration_options options = {board, pictures, "test-camera", 0.1,
                                                         scratch_path(directory, "camera.ini")};
    return sim_lens_calibrate(&options, fault);
}

static struct iso_recording_meta read_result(const char *directory)
{
    struct iso_recording_meta meta;
    struct iso_fault fault = {.text = ""};
    size_t size = 0;
    char *bytes = scratch_read(scratch_path(directory, "camera.ini"), &size);
    char *text = calloc(size + 1, 1);
    assert_non_null(text);
    memcpy(text, bytes, size);
    if (iso_recording_meta_parse("camera.ini", text, &meta, &fault)) {
        fail_msg("%s", fault.text);
    }
    free(bytes);
    free(text);
    return meta;
}

/* Returns the largest distance in pixels between the two lenses' images of a direction within the
 * picture. */
static double worst_px(const struct iso_camera *found)
{
    double worst = 0.0;
    for (double v = 20.0; v < HEIGHT - 20.0; v += 20.0) {
        for (double u = 20.0; u < WIDTH - 20.0; u += 20.0) {
            double x, y;
            const struct iso_vec3 sight = iso_camera_back_project(&truth, u, v, 1.0);
            assert_true(iso_camera_project(found, sight, &x, &y));
            worst = fmax(worst, hypot(x - u, y - v));
        }
    }
    return worst;
}

static void a_known_lens_is_found_again(void **state)
{
    struct iso_fault fault = {.text = ""};
    if (calibrate(*state, take(*state, ALL_OVER, 24, false), &fault)) {
        fail_msg("%s", fault.text);
    }
    const struct iso_recording_meta meta = read_result(*state);
    const struct iso_camera *found = &meta.camera;
    print_message("focal length %.2f %.2f, centre %.2f %.2f, k1 %.4f, k2 %.4f; worst %.2f px\n",
                  found->fx_px, found->fy_px, found->cx_px, found->cy_px, found->k1, found->k2,
                  worst_px(found));
    assert_string_equal(meta.sensor, "test-camera");
    assert_near(meta.unit_mm, 0.1, 0.0);
    assert_false(meta.nominal);
    assert_int_equal(found->width_px, WIDTH);
    assert_int_equal(found->height_px, HEIGHT);
    assert_near(found->fx_px, truth.fx_px, 0.004 * truth.fx_px);
    assert_near(found->fy_px, truth.fy_px, 0.004 * truth.fy_px);
    assert_near(found->cx_px, truth.cx_px, 2.0);
    assert_near(found->cy_px, truth.cy_px, 2.0);
    assert_near(found->k1, truth.k1, 0.02);
    assert_near(found->k2, truth.k2, 0.06);
    assert_true(worst_px(found) < 1.5);
}

static void colour_pictures_are_accepted(void **state)
{
    struct iso_fault fault = {.text = ""};
    if (calibrate(*state, take(*state, ALL_OVER, 12, true), &fault)) {
        fail_msg("%s", fault.text);
    }
    const struct iso_recording_meta meta = read_result(*state);
    assert_near(meta.camera.fx_px, truth.fx_px, 0.01 * truth.fx_px);
}

static void expect_refusal(const char *directory, enum movement movement, int n, const char *why)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(calibrate(directory, take(directory, movement, n, false), &fault), -ENODATA);
    if (!strstr(fault.text, why)) {
        fail_msg("'%s' does not say '%s'", fault.text, why);
    }
    assert_false(scratch_exists(scratch_path(directory, "camera.ini")));
}

static void too_few_pictures_are_refused(void **state)
{
    expect_refusal(*state, ALL_OVER, 7, "pictures show the whole board, 8 are needed");
}

static void repeated_pictures_are_refused(void **state)
{
    expect_refusal(*state, THE_SAME, 10, "only 1 of 10 pictures differ, 8 are needed");
}

static void a_board_in_the_middle_is_refused(void **state)
{
    expect_refusal(*state, IN_THE_MIDDLE, 14, "show it near the borders, too");
}

static void a_board_that_is_never_turned_is_refused(void **state)
{
    expect_refusal(*state, NEVER_TURNED, 20, "tilt it to all sides");
}

static void missing_and_damaged_pictures_are_named(void **state)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(calibrate(*state, scratch_path(*state, "nowhere"), &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "nowhere"));
    const char *folder = take(*state, ALL_OVER, 0, false);
    assert_int_equal(calibrate(*state, folder, &fault), -ENODATA);
    assert_non_null(strstr(fault.text, "0 pictures"));
    scratch_write_text(scratch_path(folder, "000.png"), "no PNG");
    assert_int_equal(calibrate(*state, folder, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "000.png"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_known_lens_is_found_again),
        TEST(colour_pictures_are_accepted),
        TEST(too_few_pictures_are_refused),
        TEST(repeated_pictures_are_refused),
        TEST(a_board_in_the_middle_is_refused),
        TEST(a_board_that_is_never_turned_is_refused),
        TEST(missing_and_damaged_pictures_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
