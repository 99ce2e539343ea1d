/* Cameras, frames and shrinking, compared with values calculated by hand. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/frame/shrink.h"
#include "core/frame/shrink_blocks.h"

static struct iso_camera pinhole(void)
{
    return (struct iso_camera){.projection = ISO_PINHOLE,
                               .width_px = 640,
                               .height_px = 400,
                               .fx_px = 500.0,
                               .fy_px = 520.0,
                               .cx_px = 310.0,
                               .cy_px = 205.0};
}

static void pinhole_projects_by_its_intrinsics(void **state)
{
    (void)state;
    struct iso_camera c = pinhole();
    double u, v;
    assert_true(iso_camera_project(&c, iso_vec3(60, -50, 1000), &u, &v));
    assert_true(fabs(u - (310.0 + 500.0 * 0.06)) < 1e-12);
    assert_true(fabs(v - (205.0 - 520.0 * 0.05)) < 1e-12);
    struct iso_vec3 p = iso_camera_back_project(&c, u, v, 1000.0);
    assert_true(fabs(p.x - 60) < 1e-9 && fabs(p.y + 50) < 1e-9 && p.z == 1000.0);
    assert_true(fabs(iso_camera_pixel_mm(&c, 600.0) - 1.2) < 1e-12);
}

static void nothing_is_seen_behind_a_pinhole(void **state)
{
    (void)state;
    struct iso_camera c = pinhole();
    double u = -7.0, v = -8.0;
    assert_false(iso_camera_project(&c, iso_vec3(1, 2, 0), &u, &v));
    assert_false(iso_camera_project(&c, iso_vec3(1, 2, -600), &u, &v));
    assert_true(u == -7.0 && v == -8.0);
}

static void orthographic_projects_by_its_pitch(void **state)
{
    (void)state;
    struct iso_camera c = {.projection = ISO_ORTHOGRAPHIC,
                           .width_px = 501,
                           .height_px = 751,
                           .pitch_mm = 0.32,
                           .cx_px = 250,
                           .cy_px = 375};
    double u, v;
    assert_true(iso_camera_project(&c, iso_vec3(16, -32, -5), &u, &v));
    assert_true(fabs(u - 300.0) < 1e-9 && fabs(v - 275.0) < 1e-9);
    struct iso_vec3 p = iso_camera_back_project(&c, 300, 275, 77);
    assert_true(fabs(p.x - 16) < 1e-9 && fabs(p.y + 32) < 1e-9 && p.z == 77.0);
}

static void distortion_is_undone(void **state)
{
    (void)state;
    struct iso_camera c = pinhole();
    c.k1 = -0.12;
    c.k2 = 0.05;
    c.k3 = -0.01;
    c.p1 = 0.001;
    c.p2 = -0.002;
    for (int v = 0; v < 400; v += 57) {
        for (int u = 0; u < 640; u += 71) {
            double u2, v2;
            struct iso_vec3 p = iso_camera_back_project(&c, u, v, 700.0);
            assert_true(iso_camera_project(&c, p, &u2, &v2));
            assert_true(hypot(u2 - u, v2 - v) < 1e-4);
        }
    }
    /* Barrel distortion pulls inward: a corner's ray points further out than without it. */
    struct iso_camera straight = pinhole();
    struct iso_vec3 bent = iso_camera_back_project(&c, 0, 0, 700.0);
    struct iso_vec3 plain = iso_camera_back_project(&straight, 0, 0, 700.0);
    assert_true(bent.x < plain.x - 5.0);
}

static void impossible_cameras_are_refused(void **state)
{
    (void)state;
    struct iso_fault fault = {.text = ""};
    struct iso_camera c = pinhole();
    assert_int_equal(iso_camera_check(&c, &fault), 0);
    assert_string_equal(fault.text, "");
#define REFUSED(field, value)                                \
    c = pinhole();                                           \
    c.field = value;                                         \
    fault.text[0] = '\0';                                    \
    assert_int_equal(iso_camera_check(&c, &fault), -EINVAL); \
    assert_true(fault.text[0] != '\0')
    REFUSED(fx_px, NAN);
    REFUSED(fy_px, 0.0);
    REFUSED(fx_px, -500.0);
    REFUSED(fy_px, INFINITY);
    REFUSED(cx_px, 1e9);
    REFUSED(cy_px, NAN);
    REFUSED(width_px, 0);
    REFUSED(height_px, 8193);
    REFUSED(k1, 11.0);
    REFUSED(p2, NAN);
    REFUSED(projection, ISO_PROJECTION_NONE);
    REFUSED(projection, ISO_ORTHOGRAPHIC); /* pitch is 0 */
#undef REFUSED
}

static void frames_with_bad_depths_are_refused(void **state)
{
    (void)state;
    struct iso_camera c = pinhole();
    struct iso_frame *f = NULL;
    assert_int_equal(iso_frame_new(&c, 0, 10, false, &f), -EINVAL);
    assert_int_equal(iso_frame_new(&c, 10, 9000, false, &f), -EINVAL);
    assert_null(f);
    assert_int_equal(iso_frame_new(&c, 40, 30, true, &f), 0);
    f->crop_x_px = 600;
    f->crop_y_px = 370;
    assert_int_equal(iso_frame_check(f, NULL), 0);
    const float bad[] = {NAN, INFINITY, -1.0f, 1e7f};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct iso_fault fault = {.text = ""};
        f->depth_mm[17] = bad[i];
        assert_int_equal(iso_frame_check(f, &fault), -EINVAL);
        assert_true(fault.text[0] != '\0');
    }
    f->depth_mm[17] = 0.0f;
    f->crop_x_px = 601;
    assert_int_equal(iso_frame_check(f, NULL), -EINVAL);
    iso_frame_free(f);
    iso_frame_free(NULL);
}

/* Depths are checked in groups; the last three are left over here. */
static void a_bad_depth_is_found_at_every_place(void **state)
{
    (void)state;
    const struct iso_camera c = pinhole();
    struct iso_frame *f = NULL;
    assert_int_equal(iso_frame_new(&c, 5, 3, false, &f), 0);
    for (int i = 0; i < 5 * 3; i++) {
        assert_int_equal(iso_frame_check(f, NULL), 0);
        f->depth_mm[i] = NAN;
        assert_int_equal(iso_frame_check(f, NULL), -EINVAL);
        f->depth_mm[i] = 999999.0f;
    }
    iso_frame_free(f);
}

/* A tilted plane seen by a cropped frame: each pixel of the shrunken window is on the plane. */
static void a_shrunken_frame_sees_the_same_scene(void **state)
{
    (void)state;
    struct iso_camera c = pinhole();
    struct iso_frame *f = NULL, *out = NULL;
    assert_int_equal(iso_frame_new(&c, 120, 90, false, &f), 0);
    assert_int_equal(iso_frame_new(&c, 30, 25, false, &out), 0);
    f->crop_x_px = 300;
    f->crop_y_px = 200;
    f->sequence = 9;
    for (int row = 0; row < 90; row++) {
        for (int column = 0; column < 120; column++) {
            /* z = 700 + 0.2 x - 0.1 y along the ray of the pixel */
            double x = (column + 300 - 310.0) / 500.0, y = (row + 200 - 205.0) / 520.0;
            f->depth_mm[row * 120 + column] = (float)(700.0 / (1.0 - 0.2 * x + 0.1 * y));
        }
    }
    f->depth_mm[12 * 120 + 12] = 4000.0f; /* another surface: its block leaves it out */
    struct iso_window window = {10, 8, 100, 77};
    assert_int_equal(iso_frame_shrink(f, window, 4, 30 * 25, out), 0);
    assert_int_equal(out->width_px, 25);
    assert_int_equal(out->height_px, 19);
    assert_int_equal(out->sequence, 9);
    for (int row = 0; row < 19; row++) {
        for (int column = 0; column < 25; column++) {
            struct iso_vec3 p = iso_frame_point_at(out, column, row);
            assert_true(fabs(p.z - (700.0 + 0.2 * p.x - 0.1 * p.y)) < 0.1);
        }
    }
    assert_int_equal(iso_frame_shrink(f, window, 4, 30, out), -ENOSPC);
    assert_int_equal(iso_frame_shrink(f, window, 0, 750, out), -EINVAL);
    window.column = 50;
    assert_int_equal(iso_frame_shrink(f, window, 4, 750, out), -EINVAL);
    iso_frame_free(f);
    iso_frame_free(out);
}

/* A depth, not a whole number, of one of two surfaces; `holes` of five are not measured. */
static float uneven_depth(uint32_t holes, uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u; /* Numerical Recipes */
    const uint32_t random = *state >> 8;
    const float surface_mm = random >> 23 ? 1100.0f : 700.0f;
    return random % 5 < holes ? 0.0f : surface_mm + 0.37f * (float)(random % 97);
}

/* The functions of this machine for blocks that lie side by side give what they are expected to,
 * for as many blocks as they take. */
static void expect_blocks(const float *at, int width_px, int n_blocks, const float *expected)
{
    struct {
        iso_shrink_blocks_function *function;
        int lanes;
    } const variants[] = {
        {iso_shrink_blocks, 4},
        {iso__shrink_blocks_baseline, 4},
#if defined __x86_64__
        {__builtin_cpu_supports("avx2") ? iso__shrink_blocks_avx2 : NULL, 8},
#endif
    };
    for (size_t i = 0; i < sizeof variants / sizeof *variants && variants[i].function; i++) {
        float depth[64];
        const int n = variants[i].function(at, width_px, n_blocks, depth);
        assert_int_equal(n, n_blocks - n_blocks % variants[i].lanes);
        assert_memory_equal(depth, expected, (size_t)n * sizeof *depth);
    }
}

/* Blocks of 4 x 4 are shrunk four or eight at a time where so many lie side by side. Each block
 * alone gives the same, to the bit. */
static void blocks_side_by_side_are_shrunk_like_single_ones(void **state)
{
    (void)state;
    enum { COLUMNS = 15, ROWS = 40, FACTOR = 4 };
    const struct iso_camera c = pinhole();
    struct iso_frame *f = NULL, *all = NULL, *one = NULL;
    uint32_t seed = 5;
    assert_int_equal(iso_frame_new(&c, COLUMNS * FACTOR + 1, ROWS * FACTOR, false, &f), 0);
    assert_int_equal(iso_frame_new(&c, COLUMNS, ROWS, false, &all), 0);
    assert_int_equal(iso_frame_new(&c, 1, 1, false, &one), 0);
    for (int i = 0; i < f->width_px * f->height_px; i++) {
        const uint32_t holes = (uint32_t)(i / f->width_px / FACTOR) % 5;
        f->depth_mm[i] = i < f->width_px * FACTOR ? 0.0f : uneven_depth(holes, &seed);
    }
    const struct iso_window whole = {1, 0, COLUMNS * FACTOR, ROWS * FACTOR};
    assert_int_equal(iso_frame_shrink(f, whole, FACTOR, COLUMNS * ROWS, all), 0);
    for (int row = 0; row < ROWS; row++) {
        for (int column = 0; column < COLUMNS; column++) {
            const struct iso_window block = {1 + column * FACTOR, row * FACTOR, FACTOR, FACTOR};
            assert_int_equal(iso_frame_shrink(f, block, FACTOR, 1, one), 0);
            assert_memory_equal(&all->depth_mm[row * COLUMNS + column], one->depth_mm,
                                sizeof(float));
            assert_true(row > 0 || one->depth_mm[0] == 0.0f);
        }
        expect_blocks(&f->depth_mm[row * FACTOR * f->width_px + 1], f->width_px, COLUMNS,
                      &all->depth_mm[row * COLUMNS]);
    }
    iso_frame_free(f);
    iso_frame_free(all);
    iso_frame_free(one);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pinhole_projects_by_its_intrinsics),
        cmocka_unit_test(nothing_is_seen_behind_a_pinhole),
        cmocka_unit_test(orthographic_projects_by_its_pitch),
        cmocka_unit_test(distortion_is_undone),
        cmocka_unit_test(impossible_cameras_are_refused),
        cmocka_unit_test(frames_with_bad_depths_are_refused),
        cmocka_unit_test(a_bad_depth_is_found_at_every_place),
        cmocka_unit_test(a_shrunken_frame_sees_the_same_scene),
        cmocka_unit_test(blocks_side_by_side_are_shrunk_like_single_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
