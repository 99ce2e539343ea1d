/* Pictures of fits, on an artificial frame with a flat head before a wall: places and colours are
 * calculated by hand. The test also checks which frames of a study get a picture. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/file/png.h"
#include "sim/lab/draw/colour.h"
#include "sim/lab/landmarks/study_pictures.h"
#include "sim/lab/picture/fit.h"
#include "sim/lab/picture/relief.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

enum { WIDTH = 80, HEIGHT = 60, CROP_X = 30, CROP_Y = 10, PANEL = 440, SECOND = 448 };

static float depth_mm[HEIGHT * WIDTH];
static struct iso_frame frame = {
    .camera = {.projection = ISO_PINHOLE,
               .width_px = 160,
               .height_px = 120,
               .fx_px = 100.0,
               .fy_px = 100.0,
               .cx_px = 70.0,
               .cy_px = 40.0},
    .width_px = WIDTH,
    .height_px = HEIGHT,
    .crop_x_px = CROP_X,
    .crop_y_px = CROP_Y,
    .depth_mm = depth_mm,
};

/* A rectangle of 80 x 60 mm about (10, -5, 400), counter-clockwise seen from the camera. */
static const struct iso_vec3 vertices_mm[] = {
    {-30, -35, 400}, {50, -35, 400}, {50, 25, 400}, {-30, 25, 400}};
static const uint32_t triangles[][3] = {{0, 3, 2}, {0, 2, 1}};

static void make_depth(void)
{
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column < WIDTH; column++) {
            depth_mm[row * WIDTH + column] = column < 10 ? 0.0f : 900.0f;
        }
    }
}

struct pixel {
    int r, g, b;
};

static struct pixel pixel_at(const struct iso_image *image, double x, double y)
{
    const uint8_t *p = (const uint8_t *)image->samples + (size_t)y * iso_image_row_bytes(image) +
                       3 * (size_t)x;
    return (struct pixel){p[0], p[1], p[2]};
}

static bool is_colour(struct pixel p, uint32_t rgb)
{
    return p.r == (int)(rgb >> 16 & 255) && p.g == (int)(rgb >> 8 & 255) && p.b == (int)(rgb & 255);
}

static struct iso_image draw(const struct sim_fit_view *view, const char *directory)
{
    struct iso_image image = {0};
    struct iso_fault fault = {.text = ""};
    const char *path = scratch_path(directory, "fit.png");
    make_depth();
    assert_int_equal(sim_picture_fit(view, path, &fault), 0);
    assert_int_equal(iso_png_read(path, NULL, &image, &fault), 0);
    return image;
}

/* The head covers 33..53 by 21.75..36.75 pixels of the frame. The panels show 23 pixels, from
 * (31.5, 17.75) on. */
static const double zoom = PANEL / 23.0;

static double panel_x(double x_mm)
{
    return (70.5 + 100.0 * x_mm / 400.0 - CROP_X - 31.5) * zoom;
}

static double panel_y(double y_mm)
{
    return (40.5 + 100.0 * y_mm / 400.0 - CROP_Y - 17.75) * zoom;
}

static void test_landmarks(void **state)
{
    struct iso_vec3 found_mm[ISO_LANDMARKS], true_mm[ISO_LANDMARKS];
    bool known[ISO_LANDMARKS] = {[ISO_LM_NOSE_TIP] = true};
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        found_mm[l] = iso_vec3(40, 15, 400);
        true_mm[l] = l == ISO_LM_NOSE_TIP ? iso_vec3(0, -25, 400) : iso_vec3(20, -25, 400);
    }
    static const float residual_mm[4];
    static const bool measured[4];
    const struct sim_fit_view view = {&frame,
                                      4,
                                      2,
                                      vertices_mm,
                                      triangles,
                                      residual_mm,
                                      measured,
                                      found_mm,
                                      true_mm,
                                      known,
                                      {"title", NULL, "errors"}};
    struct iso_image image = draw(&view, *state);
    assert_true(is_colour(pixel_at(&image, SECOND + panel_x(40), panel_y(15)), 0xffd23f));
    double rings = 0.0, column = 0.0, row = 0.0;
    for (int y = 0; y < 400; y++) {
        for (int x = SECOND; x < SECOND + PANEL; x++) {
            if (is_colour(pixel_at(&image, x, y), 0x3ddc84)) {
                rings += 1.0;
                column += x + 0.5;
                row += y + 0.5;
            }
        }
    }
    /* One ring, because one landmark is known. */
    assert_true(rings > 20.0 && rings < 80.0);
    assert_near(column / rings, SECOND + panel_x(0), 1.0);
    assert_near(row / rings, panel_y(-25), 1.0);
    iso_image_done(&image);
}

static void test_head(void **state)
{
    /* The head is in front of the surface on the picture's right, and behind it on the left. */
    static const float residual_mm[] = {-8.0f, 8.0f, 8.0f, -8.0f};
    static const bool measured[] = {true, true, true, true};
    struct sim_fit_view view = {.frame = &frame,
                                .n_vertices = 4,
                                .n_triangles = 2,
                                .vertices_mm = vertices_mm,
                                .triangles = triangles,
                                .residual_mm = residual_mm,
                                .measured = measured};
    struct iso_image image = draw(&view, *state);
    struct pixel left = pixel_at(&image, SECOND + panel_x(-28), SECOND + panel_y(10));
    struct pixel right = pixel_at(&image, SECOND + panel_x(48), SECOND + panel_y(10));
    struct pixel middle = pixel_at(&image, SECOND + panel_x(10), SECOND + panel_y(10));
    assert_true(left.b > left.r + 50 && right.r > right.b + 50);
    assert_in_range(middle.r, 200, 255);
    assert_in_range(middle.b, 200, 255);
    /* The mesh panel is bluish inside the head, grey outside. */
    struct pixel inside = pixel_at(&image, panel_x(0), SECOND + panel_y(15));
    struct pixel outside = pixel_at(&image, panel_x(0), SECOND + panel_y(29));
    assert_true(inside.b > inside.r + 30);
    assert_int_equal(outside.b, outside.r);
    assert_true(outside.r > 20);
    iso_image_done(&image);

    static const bool unmeasured[4];
    view.measured = unmeasured;
    image = draw(&view, *state);
    left = pixel_at(&image, SECOND + panel_x(-28), SECOND + panel_y(10));
    assert_true(abs(left.b - left.r) < 20);
    iso_image_done(&image);
}

static void test_no_head(void **state)
{
    const struct sim_fit_view view = {.frame = &frame, .caption = {"title"}};
    struct iso_image image = draw(&view, *state);
    /* The picture shows the whole frame: 80 pixels wide, 60 of them high, with holes on the left.
     */
    struct pixel hole = pixel_at(&image, SECOND + 20, 220),
                 wall = pixel_at(&image, SECOND + 90, 220);
    assert_true(hole.b > hole.r + 20);
    assert_int_equal(wall.r, wall.b);
    assert_true(wall.r > 100);
    iso_image_done(&image);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_picture_fit(&view, scratch_path(*state, "nowhere/fit.png"), &fault), -EIO);
    assert_non_null(strstr(fault.text, "nowhere/fit.png"));
}

/* A plane that leans towards the light is brightest. One that leans away is darkest. */
static void test_relief(void **state)
{
    (void)state;
    const int slopes[] = {-1, 0, 1};
    float light[3];
    for (int k = 0; k < 3; k++) {
        for (int row = 0; row < HEIGHT; row++) {
            for (int column = 0; column < WIDTH; column++) {
                depth_mm[row * WIDTH + column] = (float)(900 + 5 * slopes[k] * (column + row));
            }
        }
        light[k] = sim_relief(&frame, 40, 30, 2);
        /* A hole beside the plane changes nothing in its brightness. */
        depth_mm[30 * WIDTH + 41] = depth_mm[29 * WIDTH + 40] = 0.0f;
        assert_near((double)sim_relief(&frame, 40, 30, 2), (double)light[k], 1e-6);
    }
    assert_true(light[0] > light[1] && light[1] > light[2]);
    depth_mm[0] = 900.0f; /* alone: its neighbours are far away */
    depth_mm[1] = depth_mm[WIDTH] = depth_mm[WIDTH + 1] = 0.0f;
    assert_near((double)sim_relief(&frame, 0, 0, 1), (double)light[1], 1e-6);
}

static void test_chosen_frames(void **state)
{
    (void)state;
    struct sim_corpus_row rows[] = {
        {.recording = "a", .count = 4, .subject = "ann"},
        {.recording = "b", .count = 1, .subject = "bob"},
        {.recording = "c", .count = 2, .subject = "none", .note = "chair"},
        {.recording = "d", .count = 2, .subject = "none", .note = "photo"},
    };
    const struct sim_corpus corpus = {4, rows};
    struct sim_measured_frame frames[] = {
        {.row = 0, .reason = ISO_CAPTURE_OK, .n_known = 12, .centred_mean_mm = 2.0},
        {.row = 0, .reason = ISO_CAPTURE_OK, .n_known = 12, .centred_mean_mm = 9.0},
        {.row = 0, .reason = SIM_REASON_UNREADABLE},
        {.row = 0, .reason = ISO_CAPTURE_LOOK_UP, .n_known = 9, .centred_mean_mm = 30.0},
        {.row = 1, .reason = ISO_CAPTURE_LOOK_UP, .n_known = 12, .centred_mean_mm = 4.0},
        {.row = 2, .reason = ISO_CAPTURE_NO_FACE, .centred_mean_mm = 99.0},
        {.row = 2, .reason = ISO_CAPTURE_NO_FACE},
        {.row = 3, .reason = ISO_CAPTURE_NO_FACE, .n_known = 12, .centred_mean_mm = 99.0},
        {.row = 3, .reason = ISO_CAPTURE_FLAT},
    };
    const struct sim_measurement measurement = {
        sizeof frames / sizeof *frames, frames, {{0, 0, 0}}, {0, ""}};
    static const struct sim_chosen_frame expected[] = {{3, 1}, {1, 2}, {0, 0}, {3, 0},
                                                       {5, 0}, {7, 0}, {8, 0}};
    struct sim_chosen_frame *chosen = NULL;
    size_t n = 0;
    assert_int_equal(sim_choose_frames(&corpus, &measurement, 2, &chosen, &n), 0);
    assert_int_equal(n, sizeof expected / sizeof *expected);
    assert_memory_equal(chosen, expected, sizeof expected);
    free(chosen);
    assert_int_equal(sim_choose_frames(&corpus, &measurement, 100, &chosen, &n), 0);
    assert_int_equal(n, 4 + 5);
    free(chosen);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_landmarks, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_head, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_no_head, scratch_setup, scratch_teardown),
        cmocka_unit_test(test_relief),
        cmocka_unit_test(test_chosen_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
