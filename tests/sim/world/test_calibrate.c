/* The calibration of the simulated rig from rendered pictures of a board. The test judges it by the
 * depths that would follow from it. */
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

#include "drivers/stereo/rectification.h"
#include "sim/world/stereo/board_picture.h"
#include "sim/world/stereo/rig.h"

static const struct iso_board board = {9, 6, 20.0};

/* Returns the depth that a rectified camera pair with the calibration `c` measures for a point that
 * the real pair sees. *row_error_px is the difference of the rows, *point_mm the measured point. */
static double believed_depth(const struct iso_stereo_calibration *real,
                             const struct iso_stereo_calibration *c, struct iso_vec3 left_mm,
                             double *row_error_px, struct iso_vec3 *point_mm)
{
    struct iso_rectification r = iso_rectification_of(c);
    struct iso_vec3 seen[ISO_EYES] = {left_mm, iso_rigid_apply(&real->right_from_left, left_mm)};
    double u[ISO_EYES], v[ISO_EYES];
    for (int eye = 0; eye < ISO_EYES; eye++) {
        double x, y;
        assert_true(iso_camera_project(&real->camera[eye], seen[eye], &x, &y));
        struct iso_vec3 sight = iso_mat3_apply(&r.rectified_from_eye[eye],
                                               iso_camera_back_project(&c->camera[eye], x, y, 1.0));
        assert_true(iso_camera_project(&r.camera, sight, &u[eye], &v[eye]));
    }
    double z_mm = r.camera.fx_px * r.baseline_mm / (u[0] - u[1]);
    *row_error_px = v[0] - v[1];
    *point_mm = iso_camera_back_project(&r.camera, u[0], v[0], z_mm);
    return z_mm;
}

struct verdict {
    double depth_rms_mm, row_rms_px;
    double curved_mm; /* depth_rms_mm without its mean */
};

/* Over the middle of the picture, where faces are, at one distance. */
static struct verdict judge(const struct iso_stereo_calibration *real,
                            const struct iso_stereo_calibration *c, double z_mm)
{
    struct verdict verdict = {0.0, 0.0, 0.0};
    double sum = 0.0;
    int n = 0;
    struct iso_rectification r = iso_rectification_of(c);
    for (double x = -100.0; x <= 100.0; x += 20.0) {
        for (double y = -120.0; y <= 120.0; y += 24.0, n++) {
            double row_px;
            struct iso_vec3 at = {x, y, z_mm}, found;
            struct iso_vec3 truth = iso_mat3_apply(&r.rectified_from_eye[ISO_EYE_LEFT], at);
            double error_mm = believed_depth(real, c, at, &row_px, &found) - truth.z;
            sum += error_mm;
            verdict.depth_rms_mm += error_mm * error_mm;
            verdict.row_rms_px += row_px * row_px;
        }
    }
    verdict.curved_mm = sqrt(verdict.depth_rms_mm / n - sum / n * sum / n);
    verdict.depth_rms_mm = sqrt(verdict.depth_rms_mm / n);
    verdict.row_rms_px = sqrt(verdict.row_rms_px / n);
    return verdict;
}

static void print_verdict(const char *what, const struct verdict *v)
{
    print_message("%s: depth error at 600 mm: rms %.2f mm, without its mean %.2f mm; row error: "
                  "rms %.3f px\n",
                  what, v->depth_rms_mm, v->curved_mm, v->row_rms_px);
}

static void the_true_calibration_has_no_error(void **state)
{
    (void)state;
    struct sim_stereo_rig rig = sim_stereo_rig(0.0);
    struct verdict v = judge(&rig.built, &rig.believed, 600.0);
    assert_true(v.depth_rms_mm < 1e-6 && v.row_rms_px < 1e-6);
    rig = sim_stereo_rig(1.0);
    v = judge(&rig.built, &rig.believed, 600.0);
    print_verdict("the simulated sensor's own error", &v);
    assert_true(v.depth_rms_mm > 0.05 && v.depth_rms_mm < 1.5 && v.row_rms_px < 0.5);
}

static void pictures_of_a_board_give_the_cameras(void **state)
{
    (void)state;
    struct sim_stereo_rig rig = sim_stereo_rig(0.0);
    const struct iso_camera *camera = rig.built.camera;
    size_t n = (size_t)camera->width_px * (size_t)camera->height_px;
    uint8_t *left = malloc(n), *right = malloc(n);
    struct iso_board_views *views = NULL;
    struct iso_stereo_calibration found;
    struct iso_fault fault = {.text = ""};
    struct sim_lens *lens[ISO_EYES];
    assert_true(left && right);
    for (int eye = 0; eye < ISO_EYES; eye++) {
        assert_int_equal(sim_lens_new(&camera[eye], &lens[eye]), 0);
    }
    assert_int_equal(iso_board_views_new(&board, camera->width_px, camera->height_px, &views, NULL),
                     0);
    assert_int_equal(iso_board_calibrate(views, NULL, NULL, &found, &fault), -ENODATA);
    assert_non_null(strstr(fault.text, "0 pairs show the whole board, 6 are needed"));
    for (uint64_t i = 0; i < 30 && iso_board_views_count(views) < 10; i++) {
        struct sim_random random = sim_random_seeded(7, 0, i);
        struct iso_rigid pose = sim_board_pose(&rig.built, &board, &random);
        struct iso_rigid other = iso_rigid_mul(&rig.built.right_from_left, &pose);
        sim_board_picture(&board, lens[0], &pose, 2.0, &random, left);
        sim_board_picture(&board, lens[1], &other, 2.0, &random, right);
        int error = iso_board_views_add(views, left, right);
        assert_true(error == 0 || error == -ENOENT);
    }
    assert_int_equal(iso_board_views_count(views), 10);
    memset(left, 128, n);
    assert_int_equal(iso_board_views_add(views, left, right), -ENOENT);
    assert_int_equal(iso_board_views_count(views), 10);
    assert_int_equal(iso_board_calibrate(views, NULL, NULL, &found, &fault), 0);
    struct verdict v = judge(&rig.built, &found, 600.0);
    print_message(
        "10 pairs: %.3f px left, focal length %.2f (true %.2f), baseline %.3f mm (%.3f)\n",
        found.rms_px, found.camera[0].fx_px, camera[0].fx_px, iso_stereo_baseline_mm(&found),
        iso_stereo_baseline_mm(&rig.built));
    print_verdict("calibrated", &v);
    assert_int_equal(found.pairs, 10);
    assert_true(found.rms_px < 0.2);
    assert_true(fabs(found.camera[0].fx_px - camera[0].fx_px) < 2.0);
    assert_true(fabs(iso_stereo_baseline_mm(&found) - iso_stereo_baseline_mm(&rig.built)) < 0.1);
    assert_true(v.depth_rms_mm < 1.5 && v.row_rms_px < 0.3);
    iso_board_views_free(views);
    sim_lens_free(lens[0]);
    sim_lens_free(lens[1]);
    free(left);
    free(right);
}

static void refuses_invalid_boards(void **state)
{
    (void)state;
    static const struct iso_board bad[] = {{2, 6, 20.0}, {9, 65, 20.0}, {9, 6, 0.0}, {9, 6, NAN}};
    struct iso_board_views *views = NULL;
    struct iso_fault fault;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(iso_board_views_new(&bad[i], 640, 480, &views, &fault), -EINVAL);
    }
    assert_int_equal(iso_board_views_new(&board, 32, 480, &views, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "32 x 480"));
    assert_null(views);
    iso_board_views_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_true_calibration_has_no_error),
        cmocka_unit_test(pictures_of_a_board_give_the_cameras),
        cmocka_unit_test(refuses_invalid_boards),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
