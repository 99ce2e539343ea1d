/* The input of the extractor: options and frames out of range are refused, and there is space for
 * every other size of frame and patch. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/core/extract/extract_rig.h"
#include "tests/core/surfaces/rendered_head.h"

static void bad_options_are_refused(void **state)
{
    struct extract_rig *f = *state;
    struct iso_extract_options bad[23];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        bad[i] = f->options;
    }
    bad[0].t_mm2 = 0.0;
    bad[1].t_mm2 = NAN;
    bad[2].n_radii = 0;
    bad[3].n_radii = ISO_TEMPLATE_RADII_MAX + 1;
    bad[4].radius_mm[0] = 0.0;
    bad[5].radius_mm[1] = 0.0;
    bad[6].n_points = 3;
    bad[7].n_points = ISO_TEMPLATE_POINTS_MAX + 1;
    bad[8].crop_radius_mm = 39.0;
    bad[9].crop_radius_mm = INFINITY;
    bad[10].spacing_mm = 0.4;
    bad[11].smoothing_mm = -1.0;
    bad[12].outlier_mm = 0.0;
    bad[13].fit.iterations = 0;
    bad[14].fit.identity_stiffness_mm2 = 0.0;
    bad[15].distance_min_mm = 0.0;
    bad[16].distance_max_mm = 299.0; /* below distance_min_mm */
    bad[17].yaw_max_rad = -0.1;
    bad[18].yaw_max_rad = NAN;
    bad[19].pitch_max_rad = 1.6;
    bad[20].heat = (enum iso_heat_method)3;
    memset(bad[21].sensor, 'a', sizeof bad[21].sensor); /* the name has no end */
    bad[22].radius_mm[0] = 101.0;                       /* beyond the crop */
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct iso_extractor *none = NULL;
        assert_int_equal(iso_extractor_new(f->model, &bad[i], &none), -EINVAL);
        assert_null(none);
    }
    iso_extractor_free(NULL);
}

static void assert_refused(struct extract_rig *f)
{
    struct iso_extraction before;
    memset(&f->out, 0x5a, sizeof f->out);
    memcpy(&before, &f->out, sizeof before);
    assert_int_equal(iso_extractor_run(f->extractor, f->frame, &f->out), -EINVAL);
    assert_memory_equal(&f->out, &before, sizeof before);
}

static void bad_frames_are_refused(void **state)
{
    struct extract_rig *f = *state;
    const float depths[] = {NAN, INFINITY, -1.0f, 2e6f};
    for (int i = 0; i < 4; i++) {
        f->frame->depth_mm[100] = depths[i];
        assert_refused(f);
    }
    f->frame->depth_mm[100] = 0.0f;
    f->frame->crop_x_px = 1;
    assert_refused(f);
    f->frame->crop_x_px = 0;
    f->frame->camera.fx_px = 0.0;
    assert_refused(f);
    iso_frame_free(f->frame);
    const int sizes[][2] = {{1921, 1200}, {1920, 1201}};
    for (int i = 0; i < 2; i++) {
        struct iso_camera camera = rendered_head_camera();
        camera.width_px = sizes[i][0];
        camera.height_px = sizes[i][1];
        assert_int_equal(iso_frame_new(&camera, sizes[i][0], sizes[i][1], false, &f->frame), 0);
        assert_refused(f);
        iso_frame_free(f->frame);
    }
    f->frame = NULL;
}

/* Frames from the largest size that the extractor accepts down to one pixel, with narrow and wide
 * views. */
static void every_size_of_frame_can_be_run(void **state)
{
    struct extract_rig *f = *state;
    const struct {
        int width, height;
        double focal_px;
        bool holds_a_face;
    } cameras[] = {
        {1920, 1200, 1700.0, true}, /* a narrow view: shrunk by 11 */
        {1920, 1200, 300.0, true},  /* so wide that the coarse frame would be too large */
        {1920, 1200, 16.0, false},  {640, 400, 65536.0, false},
        {3, 2, 2000.0, false},      {1, 1, 500.0, false},
    };
    struct iso_rigid pose = rendered_head_pose(0, 0, iso_vec3(0, 0, 420));
    for (size_t i = 0; i < sizeof cameras / sizeof cameras[0]; i++) {
        struct iso_camera camera = {.projection = ISO_PINHOLE,
                                    .width_px = cameras[i].width,
                                    .height_px = cameras[i].height,
                                    .fx_px = cameras[i].focal_px,
                                    .fy_px = cameras[i].focal_px,
                                    .cx_px = cameras[i].width / 2.0,
                                    .cy_px = cameras[i].height / 2.0};
        iso_frame_free(f->frame);
        assert_int_equal(
            iso_frame_new(&camera, camera.width_px, camera.height_px, false, &f->frame), 0);
        rendered_head_draw(f->frame, f->model, NULL, 1.0, &pose);
        enum iso_capture outcome = extract_rig_run(f);
        assert_int_equal(outcome == ISO_CAPTURE_OK, cameras[i].holds_a_face);
    }
}

/* The widest patch, at the distances at which its cut-out has the most pixels. */
static void the_widest_patch_has_room(void **state)
{
    struct extract_rig *f = *state;
    f->options.crop_radius_mm = 150.0;
    extract_rig_renew(f);
    struct iso_camera camera = {.projection = ISO_PINHOLE,
                                .width_px = 1000,
                                .height_px = 800,
                                .fx_px = 900.0,
                                .fy_px = 900.0,
                                .cx_px = 480.0,
                                .cy_px = 410.0};
    iso_frame_free(f->frame);
    assert_int_equal(iso_frame_new(&camera, 1000, 800, false, &f->frame), 0);
    for (double z_mm = 440.0; z_mm < 462.0; z_mm += 4.0) {
        assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(0, 0, z_mm)), ISO_CAPTURE_OK);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(bad_options_are_refused, extract_rig_new, extract_rig_free),
        cmocka_unit_test_setup_teardown(bad_frames_are_refused, extract_rig_new, extract_rig_free),
        cmocka_unit_test_setup_teardown(every_size_of_frame_can_be_run, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(the_widest_patch_has_room, extract_rig_new,
                                        extract_rig_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
