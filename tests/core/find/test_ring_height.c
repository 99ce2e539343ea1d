/* Heights above rings: those of a plain least-squares plane; and the quick judgement of four pixels
 * agrees with the height of each. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>

#include "core/base/solve.h"
#include "core/find/ring_height.h"

enum { WIDTH = 67, HEIGHT = 51, RING = 16, RING_MIN = 9, PLANE = 3 };

static const double radius_mm = 40.0, reach_mm = 70.0;

struct scene {
    struct iso_frame *frame;
    double column_line[WIDTH], row_line[HEIGHT];
    struct iso_sight_lines lines;
};

/* A wall that is turned, with bumps like noses, with steps and with holes. */
static void set_up(struct scene *scene, double k1, enum iso_projection projection)
{
    const struct iso_camera camera = {.projection = projection,
                                      .width_px = WIDTH,
                                      .height_px = HEIGHT,
                                      .fx_px = 110.0,
                                      .fy_px = 115.0,
                                      .cx_px = 35.2,
                                      .cy_px = 24.1,
                                      .pitch_mm = 6.0,
                                      .k1 = k1};
    const bool straight = projection == ISO_PINHOLE && k1 == 0.0;
    assert_int_equal(iso_frame_new(&camera, WIDTH, HEIGHT, false, &scene->frame), 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int u = i % WIDTH, v = i / WIDTH;
        const double bump = 35.0 * exp(-(pow(u % 22 - 11.0, 2) + pow(v % 18 - 9.0, 2)) / 12.0);
        const double step = u > 50 ? 90.0 : 0.0;
        const bool hole = (u * 7 + v * 13) % 41 == 0 || (u < 12 && v > 40);
        scene->frame->depth_mm[i] = hole ? 0.0f : (float)(600.0 + 0.7 * u + step - bump);
    }
    for (int u = 0; u < WIDTH; u++) {
        scene->column_line[u] = iso_sight_line(u, 0, camera.cx_px, camera.fx_px);
    }
    for (int v = 0; v < HEIGHT; v++) {
        scene->row_line[v] = iso_sight_line(v, 0, camera.cy_px, camera.fy_px);
    }
    scene->lines.column = straight ? scene->column_line : NULL;
    scene->lines.row = straight ? scene->row_line : NULL;
}

/* The points of the ring that are on the surface, from the pixel's own point. */
static int ring_of(const struct iso_frame *frame, int column, int row, double z_mm,
                   struct iso_vec3 off_mm[RING])
{
    const double radius_px = radius_mm / iso_camera_pixel_mm(&frame->camera, z_mm);
    const struct iso_vec3 centre = iso_camera_back_project(&frame->camera, column, row, z_mm);
    int n = 0;
    for (int k = 0; k < RING; k++) {
        const int u = column + (int)lrint(radius_px * cos(2.0 * M_PI * k / RING));
        const int v = row + (int)lrint(radius_px * sin(2.0 * M_PI * k / RING));
        if (u < 0 || v < 0 || u >= WIDTH || v >= HEIGHT) {
            continue;
        }
        const double z = (double)iso_frame_depth_at(frame, u, v);
        if (z > 0.0 && fabs(z - z_mm) <= reach_mm) {
            off_mm[n++] = iso_sub(iso_frame_point_at(frame, u, v), centre);
        }
    }
    return n;
}

/* The height above the plane through the ring; 0 for too few points. */
static double plain_height(const struct iso_frame *frame, int column, int row, double z_mm)
{
    struct iso_vec3 off_mm[RING];
    const int n = ring_of(frame, column, row, z_mm, off_mm);
    double left[PLANE * PLANE] = {0}, right[PLANE] = {0};
    for (int k = 0; k < n; k++) {
        const double basis[PLANE] = {1.0, off_mm[k].x, off_mm[k].y};
        for (int a = 0; a < PLANE; a++) {
            for (int b = 0; b < PLANE; b++) {
                left[a * PLANE + b] += basis[a] * basis[b];
            }
            right[a] += basis[a] * off_mm[k].z;
        }
    }
    if (n < RING_MIN || iso_cholesky_factorise(left, PLANE)) {
        return 0.0;
    }
    iso_cholesky_solve(left, PLANE, right);
    return right[0] / sqrt(1.0 + right[1] * right[1] + right[2] * right[2]);
}

/* Compares every pixel. Returns how many heights are those of a nose. */
static int check_heights(const struct scene *scene)
{
    int noses = 0;
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column < WIDTH; column++) {
            const double z = (double)iso_frame_depth_at(scene->frame, column, row);
            if (!(z > 0.0)) {
                continue;
            }
            const double plain = plain_height(scene->frame, column, row, z);
            const double height = iso_ring_height(scene->frame, &scene->lines, column, row, z);
            if (plain >= ISO_RING_HEIGHT_MIN_MM || height != 0.0) {
                assert_true(fabs(plain - height) < 1e-6);
            }
            noses += plain >= ISO_RING_HEIGHT_MIN_MM;
        }
    }
    return noses;
}

/* Four points of the ring, two opposite pairs: they lie on the surface, and their mean is low. */
static bool plainly_low(const struct iso_frame *frame, int column, int row, double z_mm)
{
    const int reach = (int)lrint(radius_mm / iso_camera_pixel_mm(&frame->camera, z_mm));
    const int off[4][2] = {{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}};
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const int u = column + off[k][0], v = row + off[k][1];
        if (u < 0 || v < 0 || u >= WIDTH || v >= HEIGHT) {
            return false;
        }
        const double z = (double)iso_frame_depth_at(frame, u, v);
        if (!(z > 0.0) || fabs(z - z_mm) > reach_mm) {
            return false;
        }
        sum += z;
    }
    return sum / 4.0 - z_mm < 2.0;
}

/* Compares the quick judgement of every four pixels. Returns how many are judged low. */
static int check_quick(const struct scene *scene)
{
    int judged = 0;
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column + ISO_RINGS <= WIDTH; column++) {
            double z_mm[ISO_RINGS];
            for (int k = 0; k < ISO_RINGS; k++) { /* smoothed depths are of measured pixels */
                const double z = (double)iso_frame_depth_at(scene->frame, column + k, row);
                z_mm[k] = z > 0.0 ? z : 600.0;
            }
            const unsigned low = iso_rings_are_low(scene->frame, column, row, z_mm);
            for (int k = 0; k < ISO_RINGS; k++) {
                if (low >> k & 1) {
                    assert_true(plainly_low(scene->frame, column + k, row, z_mm[k]));
                    assert_true(iso_ring_height(scene->frame, &scene->lines, column + k, row,
                                                z_mm[k]) == 0.0);
                    judged++;
                } else if (low) { /* judged, and not low */
                    assert_false(plainly_low(scene->frame, column + k, row, z_mm[k]));
                }
            }
        }
    }
    return judged;
}

static void heights_are_those_of_a_plane(void **state)
{
    (void)state;
    struct scene scene;
    set_up(&scene, 0.0, ISO_PINHOLE);
    assert_true(check_heights(&scene) > 50);
    assert_true(check_quick(&scene) > 500);
    iso_frame_free(scene.frame);
}

static void other_cameras_have_the_same_heights(void **state)
{
    (void)state;
    struct scene scene;
    set_up(&scene, 0.02, ISO_PINHOLE);
    assert_true(check_heights(&scene) > 50);
    assert_true(check_quick(&scene) > 500);
    iso_frame_free(scene.frame);
    set_up(&scene, 0.0, ISO_ORTHOGRAPHIC);
    assert_true(check_heights(&scene) > 50);
    assert_true(check_quick(&scene) > 500);
    iso_frame_free(scene.frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_are_those_of_a_plane),
        cmocka_unit_test(other_cameras_have_the_same_heights),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
