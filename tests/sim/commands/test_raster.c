/* The rasteriser, compared with the geometry of planes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/surface/raster.h"

enum { WIDTH = 40, HEIGHT = 30 };

static float depth[WIDTH * HEIGHT];
static int32_t seen[WIDTH * HEIGHT];
static float weight[WIDTH * HEIGHT][2];

static struct iso_raster pinhole(void)
{
    return (struct iso_raster){
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = 400,
                   .height_px = 300,
                   .fx_px = 50.0,
                   .fy_px = 60.0,
                   .cx_px = 119.5,
                   .cy_px = 93.0},
        .width_px = WIDTH,
        .height_px = HEIGHT,
        .crop_x_px = 100,
        .crop_y_px = 80,
        .depth_mm = depth,
        .triangle = seen,
        .weight = weight,
    };
}

/* A slanted triangle that covers the whole window, counter-clockwise seen from the camera. */
static const struct iso_vec3 slanted[3] = {
    {-900, -800, 850}, {-700, 1600, 1330}, {1800, -300, 400}};
static const uint32_t one[1][3] = {{0, 1, 2}};

static struct iso_vec3 sight(const struct iso_raster *raster, int column, int row)
{
    return iso_vec3((column + raster->crop_x_px - raster->camera.cx_px) / raster->camera.fx_px,
                    (row + raster->crop_y_px - raster->camera.cy_px) / raster->camera.fy_px, 1.0);
}

static void depth_is_where_the_sight_meets_the_plane(void **state)
{
    (void)state;
    struct iso_raster raster = pinhole();
    struct iso_vec3 normal = iso_cross(iso_sub(slanted[1], slanted[0]),
                                       iso_sub(slanted[2], slanted[0]));
    double offset = iso_dot(normal, slanted[0]);
    int covered = 0;
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, slanted, one, 1, 7, 10.0, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        if (seen[i] < 0) {
            continue;
        }
        struct iso_vec3 s = sight(&raster, i % WIDTH, i / WIDTH);
        double z = offset / iso_dot(normal, s), w1 = (double)weight[i][0];
        double w2 = (double)weight[i][1];
        struct iso_vec3 p = iso_madd(iso_madd(iso_scale(1.0 - w1 - w2, slanted[0]), w1, slanted[1]),
                                     w2, slanted[2]);
        covered++;
        assert_int_equal(seen[i], 7);
        assert_true(fabs((double)depth[i] - z) < 1e-3);
        assert_true(iso_norm(iso_sub(p, iso_scale(z, s))) < 1e-2);
    }
    assert_true(covered > WIDTH * HEIGHT / 2);
}

static void orthographic_depth_is_linear(void **state)
{
    (void)state;
    struct iso_raster raster = pinhole();
    raster.camera = (struct iso_camera){.projection = ISO_ORTHOGRAPHIC,
                                        .width_px = WIDTH,
                                        .height_px = HEIGHT,
                                        .pitch_mm = 2.0,
                                        .cx_px = 11.0,
                                        .cy_px = 5.0};
    raster.crop_x_px = 3;
    raster.crop_y_px = -2;
    const struct iso_vec3 corners[3] = {{-200, -200, 300}, {-200, 400, 420}, {400, -200, 180}};
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, corners, one, 1, 0, 10.0, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double x = 2.0 * (i % WIDTH + 3 - 11.0), y = 2.0 * (i / WIDTH - 2 - 5.0);
        double z = 300.0 - 0.2 * (x + 200.0) + 0.2 * (y + 200.0);
        assert_true(fabs((double)depth[i] - z) < 1e-3);
    }
}

static void back_faces_are_left_out_only_if_asked(void **state)
{
    (void)state;
    const uint32_t turned[1][3] = {{0, 2, 1}};
    struct iso_raster raster = pinhole();
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, slanted, turned, 1, 0, 10.0, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        assert_int_equal(seen[i], -1);
        assert_true(depth[i] <= 0.0f);
    }
    iso_raster_triangles(&raster, slanted, turned, 1, 0, 10.0, 0);
    assert_int_equal(seen[WIDTH * HEIGHT / 2 + WIDTH / 2], 0);
}

static void the_nearer_wins_in_either_order(void **state)
{
    (void)state;
    struct iso_vec3 corners[6];
    const uint32_t both[2][3] = {{0, 1, 2}, {3, 4, 5}}, reversed[2][3] = {{3, 4, 5}, {0, 1, 2}};
    struct iso_raster raster = pinhole();
    size_t middle = WIDTH * (HEIGHT / 2) + WIDTH / 2;
    for (int k = 0; k < 3; k++) {
        corners[k] = slanted[k];
        corners[k + 3] = iso_scale(0.9, slanted[k]); /* in front of it, at the same pixels */
    }
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, corners, both, 2, 0, 10.0, 1);
    assert_int_equal(seen[middle], 1);
    float nearer = depth[middle];
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, corners, reversed, 2, 0, 10.0, 1);
    assert_int_equal(seen[middle], 0);
    assert_true(fabsf(depth[middle] - nearer) < 1e-3f);
}

/* A fan of triangles about a point that is not a pixel centre, and about one that is. No pixel
 * between two triangles is left out. */
static void neighbours_leave_no_gap(void **state)
{
    enum { BLADES = 17 };
    (void)state;
    struct iso_raster raster = pinhole();
    for (int at_centre = 0; at_centre < 2; at_centre++) {
        struct iso_vec3 corners[BLADES + 1];
        uint32_t blades[BLADES][3];
        double u = at_centre ? 20.0 : 19.37, v = at_centre ? 15.0 : 14.71;
        corners[0] = iso_scale(500.0, sight(&raster, 0, 0));
        corners[0].x += 500.0 * u / 50.0;
        corners[0].y += 500.0 * v / 60.0;
        for (int k = 0; k < BLADES; k++) {
            double angle = 2.0 * 3.14159265358979 * k / BLADES;
            corners[k + 1] = iso_vec3(corners[0].x + 900.0 * cos(angle),
                                      corners[0].y - 900.0 * sin(angle), 500.0);
            blades[k][0] = 0;
            blades[k][1] = (uint32_t)k + 1;
            blades[k][2] = (uint32_t)(k + 1) % BLADES + 1;
        }
        iso_raster_clear(&raster);
        iso_raster_triangles(&raster, corners, (const uint32_t(*)[3])blades, BLADES, 0, 10.0, 1);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            assert_true(fabsf(depth[i] - 500.0f) < 1e-3f);
        }
    }
}

static void near_and_absurd_corners_leave_a_triangle_out(void **state)
{
    (void)state;
    struct iso_raster raster = pinhole();
    struct iso_vec3 corners[3];
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, slanted, one, 1, 0, 400.5, 1); /* one corner is at 400 */
    memcpy(corners, slanted, sizeof corners);
    corners[1].x = NAN;
    iso_raster_triangles(&raster, corners, one, 1, 0, 10.0, 1);
    memcpy(corners, slanted, sizeof corners);
    corners[0].z = -5.0;
    iso_raster_triangles(&raster, corners, one, 1, 0, -1e9, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        assert_int_equal(seen[i], -1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depth_is_where_the_sight_meets_the_plane),
        cmocka_unit_test(orthographic_depth_is_linear),
        cmocka_unit_test(back_faces_are_left_out_only_if_asked),
        cmocka_unit_test(the_nearer_wins_in_either_order),
        cmocka_unit_test(neighbours_leave_no_gap),
        cmocka_unit_test(near_and_absurd_corners_leave_a_triangle_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
