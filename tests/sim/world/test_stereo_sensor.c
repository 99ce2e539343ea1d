/* The simulated stereo sensor. It renders the pictures of two cameras, and the depths that the
 * product computes from them have the stated accuracy. */
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

#include "sim/world/prop/solid.h"
#include "sim/world/scene/depth_error.h"
#include "sim/world/stereo/stereo_scene.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

/* The light of the dots does not depend on their width: its mean over directions is 1. */
static void dots_neither_add_nor_swallow_light(void **state)
{
    (void)state;
    struct sim_stereo_rig rig = sim_stereo_rig(0.0);
    for (double radius = 0.0012; radius < 0.0035; radius *= 1.6) {
        double sum = 0.0;
        enum { SIDE = 600 };
        for (int i = 0; i < SIDE * SIDE; i++) {
            double x = (i % SIDE) * 0.001 - 0.3, y = (double)(i / SIDE) * 0.001 - 0.3;
            sum += sim_dots(&rig, x, y, radius);
        }
        print_message("dots of radius %.4f: mean light %.3f\n", radius, sum / (SIDE * SIDE));
        assert_true(fabs(sum / (SIDE * SIDE) - 1.0) < 0.03);
    }
}

/* The picture agrees with the depths: it is bright on the sheet, which has n_on pixels, and dark
 * beside it. */
static void check_picture(const struct sim_sensor *sensor, const struct sim_view *view,
                          struct sim_random *random, struct sim_sensor_workspace *workspace,
                          size_t n_on)
{
    float *picture = calloc(workspace->n_pixels, sizeof *picture);
    double on = 0.0, beside = 0.0;
    assert_non_null(picture);
    sim_infrared_measure(sensor, view, 1.0, random, workspace, picture);
    for (size_t i = 0; i < workspace->n_pixels; i++) {
        *(view->depth_mm[i] > 0.0f ? &on : &beside) += (double)picture[i];
    }
    on /= (double)n_on;
    beside /= (double)(workspace->n_pixels - n_on);
    print_message("brightness %.2f on the surface, %.2f beside it\n", on, beside);
    assert_true(on > 0.15 && on < 0.8 && beside < 0.03);
    free(picture);
}

/* A bent sheet of skin, 600 mm away. Its depth is known, and it needs no head model. */
static void a_bent_sheet_comes_out_right(void **state)
{
    (void)state;
    const struct sim_sensor *sensor = sim_sensor_find("stereo");
    struct sim_random random = sim_random_seeded(3, 0, 0);
    struct iso_rigid placed = {iso_mat3_rotation(iso_vec3(0.1, 0.2, 0.0)), {0.0, 0.0, 600.0}};
    struct sim_sensor_workspace *workspace = NULL;
    struct sim_view *view = NULL;
    struct iso_frame *frame = NULL;
    struct sim_solid *sheet = NULL;
    struct iso_vec3 scratch[256];
    assert_non_null(sensor);
    assert_int_equal(sim_view_new(&sensor->camera, 1, &view), 0);
    assert_int_equal(sim_sensor_workspace_new(sensor, &workspace), 0);
    assert_int_equal(iso_frame_new(&sensor->camera, 1280, 800, false, &frame), 0);
    assert_int_equal(sim_solid_rectangle(200.0, 180.0, 150.0, SIM_SKIN, &sheet), 0);
    sim_sensor_attach(workspace, view);
    sim_view_clear(view);
    assert_int_equal(sim_solid_draw(sheet, &placed, scratch, view), 0);
    sim_view_finish(view);
    sim_sensor_measure(sensor, view, 1.0, &random, workspace, frame);
    double squares = 0.0, sum = 0.0;
    size_t n = 0, holes = 0;
    for (size_t i = 0; i < workspace->n_pixels; i++) {
        if (view->depth_mm[i] > 0.0f && frame->depth_mm[i] > 0.0f) {
            double error = (double)(frame->depth_mm[i] - view->depth_mm[i]);
            squares += error * error;
            sum += error;
            n++;
        } else {
            holes += view->depth_mm[i] > 0.0f;
        }
    }
    check_picture(sensor, view, &random, workspace, n + holes);
    print_message("sheet at 600 mm: %zu pixels, rms %.2f mm, bias %+.2f mm, holes %.2f %%\n", n,
                  sqrt(squares / (double)n), sum / (double)n,
                  100.0 * (double)holes / (double)(n + holes));
    assert_true(n > 40000);
    assert_true(sqrt(squares / (double)n) < 1.2);
    assert_true((double)holes < 0.05 * (double)(n + holes));
    sim_solid_free(sheet);
    iso_frame_free(frame);
    sim_view_free(view);
    sim_sensor_workspace_free(workspace);
}

static struct sim_ict *load_model(void)
{
    const char *directory = shared_data_or_skip("data/ict-face");
    struct sim_ict *ict = NULL;
    assert_int_equal(sim_ict_load(directory, &ict, NULL), 0);
    return ict;
}

/* The required accuracy of the sensor: at 0.6 m with 60 mm between the cameras, at most 1.2 mm rms
 * on skin, and 5 % of the face without a depth. */
static void faces_at_60_cm_come_out_right(void **state)
{
    (void)state;
    struct sim_ict *ict = load_model();
    struct sim_depth_error_options options = {
        .ict = ict, .sensor = sim_sensor_find("stereo"), .faces = 2, .seed = 1, .noise_scale = 1.0};
    struct sim_depth_error e;
    assert_int_equal(sim_depth_error_measure(&options, 600.0, &e, NULL), 0);
    print_message("%zu faces at 600 mm, %zu pixels: rms %.2f mm, bias %+.2f, median %.2f, 95 %% "
                  "%.2f, over 5 mm %.2f %%, holes %.2f %%\n",
                  e.faces, e.pixels, e.rms_mm, e.bias_mm, e.median_mm, e.p95_mm, 100.0 * e.gross,
                  100.0 * (double)e.holes / (double)e.pixels);
    assert_true(e.pixels > 50000);
    assert_true(e.rms_mm <= 1.2);
    assert_true((double)e.holes <= 0.05 * (double)e.pixels);
    sim_ict_free(ict);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dots_neither_add_nor_swallow_light),
        cmocka_unit_test(a_bent_sheet_comes_out_right),
        cmocka_unit_test(faces_at_60_cm_come_out_right),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
