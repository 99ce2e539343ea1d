/* Cleaning, filling, triangulating and locating on known surfaces. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/surface/clean.h"
#include "core/surface/fill.h"
#include "isotherm/triangulate.h"

enum { W = 9, H = 6 };

static const struct iso_triangulate_options cut_at_10 = {.jump_mm = 10.0};

/* A W x H orthographic frame of 2 mm pitch. The caller sets the depths. */
static struct iso_frame grid_frame(float depth[W * H])
{
    return (struct iso_frame){
        .camera = {.projection = ISO_ORTHOGRAPHIC,
                   .width_px = W,
                   .height_px = H,
                   .pitch_mm = 2.0,
                   .cx_px = 4,
                   .cy_px = 2},
        .width_px = W,
        .height_px = H,
        .depth_mm = depth,
    };
}

static void fill_slope(float depth[W * H])
{
    for (int i = 0; i < W * H; i++) {
        depth[i] = 500.0f + 1.5f * (float)(i % W) - 0.5f * (float)(i / W);
    }
}

struct fixture {
    float depth[W * H];
    struct iso_frame frame;
    struct iso_triangulator *triangulator;
    struct iso_mesh *mesh;
};

static void set_up(struct fixture *f, const struct iso_triangulate_options *options)
{
    fill_slope(f->depth);
    f->frame = grid_frame(f->depth);
    assert_int_equal(iso_triangulator_new(W * H, options, &f->triangulator), 0);
    assert_int_equal(iso_mesh_new(W * H, 2 * W * H, &f->mesh), 0);
}

static void tear_down(struct fixture *f)
{
    iso_triangulator_free(f->triangulator);
    iso_mesh_free(f->mesh);
}

static void a_full_grid_gives_two_triangles_a_cell(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f, &cut_at_10);
    assert_int_equal(iso_triangulate(f.triangulator, &f.frame, f.mesh), 0);
    assert_int_equal(f.mesh->n_vertices, W * H);
    assert_int_equal(f.mesh->n_triangles, 2 * (W - 1) * (H - 1));
    assert_int_equal(iso_mesh_check(f.mesh, NULL), 0);
    /* The area of the slope is that of its projection times sqrt(1 + slope^2). */
    double shadow = 2.0 * (W - 1) * 2.0 * (H - 1);
    double stretch = sqrt(1.0 + 0.75 * 0.75 + 0.25 * 0.25);
    assert_true(fabs(iso_mesh_area(f.mesh) - shadow * stretch) < 1e-3);
    for (int32_t t = 0; t < f.mesh->n_triangles; t++) {
        const int32_t *v = f.mesh->triangles[t];
        struct iso_vec3 a = f.mesh->vertices_mm[v[0]];
        struct iso_vec3 n = iso_cross(iso_sub(f.mesh->vertices_mm[v[1]], a),
                                      iso_sub(f.mesh->vertices_mm[v[2]], a));
        assert_true(n.z < 0.0); /* towards the camera */
    }
    tear_down(&f);
}

static void the_shorter_diagonal_is_taken(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f, &cut_at_10);
    /* Raises one corner of cell (3, 2), so that the diagonal through it is the longer one. */
    for (int corner = 0; corner < 4; corner++) {
        for (int i = 0; i < W * H; i++) {
            f.depth[i] = 500.0f;
        }
        f.depth[(2 + (corner >> 1)) * W + 3 + (corner & 1)] = 505.0f;
        assert_int_equal(iso_triangulate(f.triangulator, &f.frame, f.mesh), 0);
        struct iso_surface_point centre;
        assert_int_equal(iso_triangulate_locate(f.triangulator, 3.5, 2.5, &centre), 0);
        double z = iso_mesh_point_at(f.mesh, centre).z;
        assert_true(fabs(z - 500.0) < 1e-9); /* on the other diagonal, which stayed flat */
    }
    tear_down(&f);
}

static void holes_and_jumps_are_cut(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f, &cut_at_10);
    f.depth[2 * W + 4] = 0.0f; /* four cells lose one corner: one triangle each */
    assert_int_equal(iso_triangulate(f.triangulator, &f.frame, f.mesh), 0);
    assert_int_equal(f.mesh->n_triangles, 2 * (W - 1) * (H - 1) - 4);
    assert_int_equal(f.mesh->n_vertices, W * H - 1);
    struct iso_surface_point p;
    assert_int_equal(iso_triangulate_locate(f.triangulator, 4.0, 2.0, &p), -ENOENT);
    assert_int_equal(iso_triangulate_locate(f.triangulator, -0.1, 2.0, &p), -ENOENT);

    fill_slope(f.depth);
    for (int row = 0; row < H; row++) { /* columns from 6 on are 50 mm further back */
        for (int column = 6; column < W; column++) {
            f.depth[row * W + column] += 50.0f;
        }
    }
    assert_int_equal(iso_triangulate(f.triangulator, &f.frame, f.mesh), 0);
    assert_int_equal(f.mesh->n_triangles, 2 * (W - 2) * (H - 1));
    tear_down(&f);

    const struct iso_triangulate_options largest = {.jump_mm = 10.0, .largest_only = true};
    struct fixture g;
    set_up(&g, &largest);
    for (int row = 0; row < H; row++) {
        for (int column = 6; column < W; column++) {
            g.depth[row * W + column] += 50.0f;
        }
    }
    assert_int_equal(iso_triangulate(g.triangulator, &g.frame, g.mesh), 0);
    assert_int_equal(g.mesh->n_triangles, 2 * 5 * (H - 1));
    assert_int_equal(g.mesh->n_vertices, 6 * H);
    assert_int_equal(iso_triangulate_locate(g.triangulator, 7.5, 2.5, &p), -ENOENT);
    assert_int_equal(iso_triangulate_locate(g.triangulator, 4.25, 2.5, &p), 0);
    struct iso_vec3 at = iso_mesh_point_at(g.mesh, p);
    assert_true(fabs(at.x - 2.0 * (4.25 - 4)) < 1e-9 && fabs(at.y - 2.0 * (2.5 - 2)) < 1e-9);
    tear_down(&g);
}

static void triangulating_nothing_is_an_error(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f, &cut_at_10);
    for (int i = 0; i < W * H; i++) {
        f.depth[i] = i % 2 ? 500.0f : 0.0f;
    }
    assert_int_equal(iso_triangulate(f.triangulator, &f.frame, f.mesh), -ENODATA);
    tear_down(&f);
    struct iso_triangulator *none = NULL;
    assert_int_equal(iso_triangulator_new(0, &cut_at_10, &none), -EINVAL);
    const struct iso_triangulate_options bad = {.jump_mm = 0.0};
    assert_int_equal(iso_triangulator_new(10, &bad, &none), -EINVAL);
    assert_int_equal(iso_triangulator_new(10, &cut_at_10, &none), 0);
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(W * H, 5, &mesh), 0);
    fill_slope(f.depth);
    assert_int_equal(iso_triangulate(none, &f.frame, mesh), -ENOSPC);
    iso_triangulator_free(none);
    assert_int_equal(iso_triangulator_new(W * H, &cut_at_10, &none), 0);
    assert_int_equal(iso_triangulate(none, &f.frame, mesh), -ENOSPC);
    iso_triangulator_free(none);
    iso_mesh_free(mesh);
}

/* A harmonic function is its own membrane, so that a hole in it is filled almost exactly. */
static void a_hole_is_filled_by_the_membrane(void **state)
{
    (void)state;
    enum { SIDE = 41 };
    uint8_t domain[SIDE * SIDE], known[SIDE * SIDE];
    float value[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = i % SIDE - 20, y = i / SIDE - 17;
        domain[i] = hypot(x, y) < 20.0;
        known[i] = domain[i] && !(fabs(x - 4) < 5 && fabs(y + 2) < 4);
        value[i] = known[i] ? (float)(0.05 * (x * x - y * y) + 0.3 * x) : 99.0f;
    }
    struct iso_fill *fill = NULL;
    assert_int_equal(iso_fill_new(SIDE, SIDE, domain, 0.0, &fill), 0);
    iso_fill_holes(fill, known, value);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = i % SIDE - 20, y = i / SIDE - 17;
        double truth = domain[i] ? 0.05 * (x * x - y * y) + 0.3 * x : 0.0;
        assert_true(fabs((double)value[i] - truth) < 0.05);
    }
    iso_fill_free(fill);
    assert_int_equal(iso_fill_new(0, SIDE, domain, 0.0, &fill), -EINVAL);
    assert_int_equal(iso_fill_new(SIDE, 1025, domain, 0.0, &fill), -EINVAL);
}

static void smoothing_keeps_constants_and_calms_noise(void **state)
{
    (void)state;
    enum { WIDE = 50, HIGH = 30 };
    uint8_t domain[WIDE * HIGH];
    float value[WIDE * HIGH];
    for (int i = 0; i < WIDE * HIGH; i++) {
        domain[i] = i % WIDE > 3 && i / WIDE < 25;
        value[i] = 7.0f;
    }
    struct iso_fill *fill = NULL;
    assert_int_equal(iso_fill_new(WIDE, HIGH, domain, 2.0, &fill), 0);
    iso_fill_smooth(fill, value);
    for (int i = 0; i < WIDE * HIGH; i++) {
        assert_true(fabsf(value[i] - (domain[i] ? 7.0f : 0.0f)) < 1e-4f);
    }
    value[10 * WIDE + 20] = 1007.0f; /* an impulse comes out as the Gaussian */
    iso_fill_smooth(fill, value);
    double peak = 1000.0 / (2.0 * M_PI * 4.0);
    assert_true(fabs((double)value[10 * WIDE + 20] - 7.0 - peak) < 0.01 * peak);
    double off = peak * exp(-0.5 * 9.0 / 4.0);
    assert_true(fabs((double)value[10 * WIDE + 23] - 7.0 - off) < 0.01 * peak);
    iso_fill_free(fill);
}

enum { CLEAN_W = 100, CLEAN_H = 80 };

static struct iso_camera clean_camera(void)
{
    return (struct iso_camera){.projection = ISO_PINHOLE,
                               .width_px = CLEAN_W,
                               .height_px = CLEAN_H,
                               .fx_px = 300.0,
                               .fy_px = 300.0,
                               .cx_px = 50.0,
                               .cy_px = 40.0};
}

static void cleaning_drops_flyers_and_crumbs(void **state)
{
    (void)state;
    struct iso_camera camera = clean_camera();
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, CLEAN_W, CLEAN_H, false, &frame), 0);
    for (int row = 15; row < 65; row++) {
        for (int column = 20; column < 80; column++) {
            frame->depth_mm[row * CLEAN_W + column] = 600.0f; /* 2 mm a pixel: 100 x 120 mm */
        }
    }
    frame->depth_mm[40 * CLEAN_W + 50] = 560.0f; /* a single wrong pixel */
    for (int row = 68; row < 76; row++) {        /* a small piece of 16 x 16 mm */
        for (int column = 84; column < 92; column++) {
            frame->depth_mm[row * CLEAN_W + column] = 600.0f;
        }
    }
    struct iso_cleaner *cleaner = NULL;
    assert_int_equal(iso_cleaner_new(CLEAN_W * CLEAN_H, &cleaner), 0);
    const struct iso_frame *out = NULL;
    struct iso_vec3 centre = {0, 0, 600};
    assert_int_equal(iso_clean(cleaner, frame, centre, 300.0, 1.0, &out), 0);
    assert_int_equal(out->width_px, CLEAN_W);
    assert_true(iso_frame_depth_at(out, 50, 40) == 0.0f);
    assert_true(iso_frame_depth_at(out, 51, 40) == 600.0f);
    assert_true(iso_frame_depth_at(out, 30, 30) == 600.0f);
    assert_true(iso_frame_depth_at(out, 88, 72) == 0.0f);
    /* A smaller square at a coarser pitch sees the same places. */
    assert_int_equal(iso_clean(cleaner, frame, centre, 41.0, 4.5, &out), 0);
    assert_int_equal(out->width_px, 20);
    assert_true(fabs(iso_frame_point_at(out, 10, 10).x) < 4.0);
    assert_int_equal(iso_clean(cleaner, frame, iso_vec3(5000, 0, 600), 50.0, 1.0, &out), -ENODATA);
    iso_cleaner_free(cleaner);
    assert_int_equal(iso_cleaner_new(100, &cleaner), 0);
    assert_int_equal(iso_clean(cleaner, frame, centre, 300.0, 1.0, &out), -ENOSPC);
    iso_cleaner_free(cleaner);
    assert_int_equal(iso_cleaner_new(0, &cleaner), -EINVAL);
    iso_frame_free(frame);
}

/* The share of an upright plane's pixels that cleaning keeps. The plane is as steep as the side of
 * a nose: 3.5 mm a pixel of 2 mm. Its depths are rounded to multiples of step_mm, and every fifth
 * pixel of a row in five flies, by flyer_mm. *flyers becomes the number of those that are kept. */
static double kept_of_a_steep_plane(double step_mm, float flyer_mm, int *flyers)
{
    struct iso_camera camera = clean_camera();
    struct iso_frame *frame = NULL;
    struct iso_cleaner *cleaner = NULL;
    const struct iso_frame *out = NULL;
    int kept = 0, n = 0;
    assert_int_equal(iso_frame_new(&camera, CLEAN_W, CLEAN_H, false, &frame), 0);
    for (int i = 0; i < CLEAN_W * CLEAN_H; i++) {
        const double z = 600.0 + 3.5 * (i % CLEAN_W - 50);
        frame->depth_mm[i] = (float)(step_mm * nearbyint(z / step_mm));
        const bool flies = i % CLEAN_W % 5 == 0 && i / CLEAN_W % 5 == 0;
        frame->depth_mm[i] += flies ? flyer_mm : 0.0f;
    }
    assert_int_equal(iso_cleaner_new(CLEAN_W * CLEAN_H, &cleaner), 0);
    assert_int_equal(iso_clean(cleaner, frame, iso_vec3(0, 0, 600), 300.0, 1.0, &out), 0);
    *flyers = 0;
    for (int row = 2; row < CLEAN_H - 2; row++) { /* the border is dropped */
        for (int column = 2; column < CLEAN_W - 2; column++) {
            const bool is_kept = iso_frame_depth_at(out, column, row) > 0.0f;
            const bool flies = column % 5 == 0 && row % 5 == 0;
            *flyers += is_kept && flies;
            kept += is_kept && !flies;
            n += !flies;
        }
    }
    iso_cleaner_free(cleaner);
    iso_frame_free(frame);
    return (double)kept / n;
}

static void cleaning_keeps_slopes_whose_depths_come_in_coarse_steps(void **state)
{
    (void)state;
    for (int step_mm = 1; step_mm <= 10; step_mm++) {
        int flyers = 0;
        assert_true(kept_of_a_steep_plane(step_mm, 40.0f, &flyers) > 0.95);
        assert_int_equal(flyers, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_full_grid_gives_two_triangles_a_cell),
        cmocka_unit_test(the_shorter_diagonal_is_taken),
        cmocka_unit_test(holes_and_jumps_are_cut),
        cmocka_unit_test(triangulating_nothing_is_an_error),
        cmocka_unit_test(a_hole_is_filled_by_the_membrane),
        cmocka_unit_test(smoothing_keeps_constants_and_calms_noise),
        cmocka_unit_test(cleaning_drops_flyers_and_crumbs),
        cmocka_unit_test(cleaning_keeps_slopes_whose_depths_come_in_coarse_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
