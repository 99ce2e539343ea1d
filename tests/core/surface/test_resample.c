/* The patch that is resampled from a frame equals that of the frame's mesh: to the bit, unless the
 * compiler fuses multiplications with additions, which changes the last bits. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/surface/face_patch.h"
#include "isotherm/triangulate.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"

static const double jump_mm = 10.0;

#ifdef __FP_FAST_FMA
static const float within_mm = 1e-3f;
#else
static const float within_mm = 0.0f;
#endif

struct fixture {
    struct iso_head_model *model;
    struct iso_face_patch *patch;
    struct iso_frame *frame;
    struct iso_triangulator *triangulator;
    struct iso_mesh *mesh;
    float *by_mesh; /* the patch of the mesh */
    size_t n;       /* pixels of the patch */
};

static int set_up(void **state)
{
    static const struct iso_face_patch_options options = {
        .radius_mm = 100.0, .spacing_mm = 2.0, .smoothing_mm = 3.0, .outlier_mm = 20.0};
    static const struct iso_triangulate_options cut = {.jump_mm = jump_mm};
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->model = shipped_head_model();
    f->frame = rendered_head_frame();
    const int32_t n_px = f->frame->width_px * f->frame->height_px;
    assert_int_equal(iso_face_patch_new(f->model, &options, &f->patch), 0);
    assert_int_equal(iso_triangulator_new((size_t)n_px, &cut, &f->triangulator), 0);
    assert_int_equal(iso_mesh_new(n_px, 2 * n_px, &f->mesh), 0);
    const struct iso_frame *grid = iso_face_patch_frame(f->patch);
    f->n = (size_t)grid->width_px * (size_t)grid->height_px;
    f->by_mesh = calloc(f->n, sizeof *f->by_mesh);
    assert_non_null(f->by_mesh);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    iso_face_patch_free(f->patch);
    iso_frame_free(f->frame);
    iso_triangulator_free(f->triangulator);
    iso_mesh_free(f->mesh);
    iso_head_model_free(f->model);
    free(f->by_mesh);
    free(f);
    return 0;
}

/* A number of 0..1 that looks random and is the same in every run. */
static double noise(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

/* Draws a head, also before a wall, with noise, single pixels that were not measured, and a few
 * that fly before and behind the surface. */
static void draw(struct fixture *f, const struct iso_rigid *pose, double noise_mm, uint32_t seed)
{
    rendered_head_clear(f->frame);
    rendered_head_draw(f->frame, f->model, NULL, 1.0, pose);
    if (seed % 3 == 0) {
        rendered_head_wall(f->frame, (float)pose->translation_mm.z + 80.0f);
    }
    for (int i = 0; i < f->frame->width_px * f->frame->height_px; i++) {
        if (!(f->frame->depth_mm[i] > 0.0f)) {
            continue;
        }
        const double rare = noise(&seed);
        double z = (double)f->frame->depth_mm[i] + noise_mm * (noise(&seed) - 0.5);
        z += rare < 0.01 ? 8.0 : rare < 0.02 ? -8.0 : rare < 0.03 ? -30.0 : 0.0;
        f->frame->depth_mm[i] = rare > 0.95 ? 0.0f : (float)z;
    }
}

/* Builds the patch both ways and compares them. */
static void assert_same_patch(struct fixture *f, const struct iso_rigid *pose, double coverage_min)
{
    assert_int_equal(iso_triangulate(f->triangulator, f->frame, f->mesh), 0);
    const double coverage = iso_face_patch_build(f->patch, f->mesh, pose);
    const struct iso_frame *patch = iso_face_patch_frame(f->patch);
    memcpy(f->by_mesh, patch->depth_mm, f->n * sizeof *f->by_mesh);
    assert_true(coverage > coverage_min);
    assert_true(iso_face_patch_resample(f->patch, f->frame, jump_mm, pose) == coverage);
    for (size_t i = 0; i < f->n; i++) {
        assert_true(fabsf(patch->depth_mm[i] - f->by_mesh[i]) <= within_mm);
    }
}

static void heads_in_many_poses_are_the_same(void **state)
{
    struct fixture *f = *state;
    for (int i = 0; i < 7; i++) {
        const struct iso_vec3 nose_mm = {30.0 * (i % 3) - 30.0, 15.0 * (i % 5) - 30.0,
                                         350.0 + 90.0 * (i % 7)};
        const struct iso_rigid pose = rendered_head_pose(9.0 * (i % 9) - 36.0, 7.0 * (i % 7) - 21.0,
                                                         nose_mm);
        draw(f, &pose, 0.5 * (i % 4), (uint32_t)i);
        assert_same_patch(f, &pose, 0.4);
    }
}

static void cameras_of_every_kind_are_the_same(void **state)
{
    struct fixture *f = *state;
    const struct iso_rigid pose = rendered_head_pose(14.0, -8.0, iso_vec3(20, 10, 500));
    draw(f, &pose, 1.0, 77);
    /* The frame is what another camera might have seen of a slightly bent face. */
    f->frame->camera.k1 = 0.05;
    f->frame->camera.p2 = -0.002;
    assert_same_patch(f, &pose, 0.5);
    f->frame->camera = (struct iso_camera){.projection = ISO_ORTHOGRAPHIC,
                                           .width_px = 640,
                                           .height_px = 480,
                                           .pitch_mm = 0.9,
                                           .cx_px = 310.0,
                                           .cy_px = 250.0};
    assert_same_patch(f, &pose, 0.4);
}

/* A window of the camera's image whose width is no multiple of the cells that are worked on at
 * once. */
static void windows_are_the_same(void **state)
{
    struct fixture *f = *state;
    const struct iso_rigid pose = rendered_head_pose(-5.0, 3.0, iso_vec3(0, 0, 520));
    draw(f, &pose, 1.0, 5);
    const struct iso_frame whole = *f->frame;
    for (int width = 196; width < 201; width++) {
        struct iso_frame window = whole;
        window.crop_x_px = 210;
        window.crop_y_px = 140;
        window.width_px = width;
        window.height_px = 220;
        window.depth_mm = calloc((size_t)width * 220, sizeof *window.depth_mm);
        assert_non_null(window.depth_mm);
        for (int row = 0; row < window.height_px; row++) {
            memcpy(&window.depth_mm[row * width], &whole.depth_mm[(row + 140) * 640 + 210],
                   (size_t)width * sizeof *window.depth_mm);
        }
        *f->frame = window;
        assert_same_patch(f, &pose, 0.5);
        free(window.depth_mm);
    }
    *f->frame = whole;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(heads_in_many_poses_are_the_same, set_up, tear_down),
        cmocka_unit_test_setup_teardown(cameras_of_every_kind_are_the_same, set_up, tear_down),
        cmocka_unit_test_setup_teardown(windows_are_the_same, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
