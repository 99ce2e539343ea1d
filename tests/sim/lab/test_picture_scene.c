/* Pictures: the place of each object, hidden objects, and the written files. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/file/png.h"
#include "sim/lab/draw/plot.h"
#include "sim/lab/picture/depth.h"
#include "sim/lab/picture/scene.h"
#include "tests/support/scratch.h"

enum { WIDTH = 80, HEIGHT = 60, S = SIM_CANVAS_SUPERSAMPLING };

static const struct sim_colour red = {1.0f, 0.0f, 0.0f}, black = {0.0f, 0.0f, 0.0f};

/* A canvas and a scene of two squares that face the viewer: 40 x 20 mm at z = 0, and 10 x 10 mm at
 * z = 30 about (10, 5), in front of its upper right part. */
struct fixture {
    struct iso_mesh *mesh;
    struct sim_canvas *canvas;
    struct sim_scene *scene;
};

static void add_square(struct iso_mesh *mesh, double x, double y, double z, double width,
                       double height)
{
    int32_t v = mesh->n_vertices;
    for (int k = 0; k < 4; k++) {
        double right = k == 1 || k == 2, top = k >= 2;
        mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(x + (right - 0.5) * width,
                                                         y + (top - 0.5) * height, z);
    }
    const int32_t triangles[2][3] = {{v, v + 1, v + 2}, {v, v + 2, v + 3}};
    memcpy(mesh->triangles[mesh->n_triangles], triangles, sizeof triangles);
    mesh->n_triangles += 2;
}

static struct fixture new_fixture(double yaw_rad)
{
    struct fixture f = {NULL, NULL, NULL};
    assert_int_equal(iso_mesh_new(8, 4, &f.mesh), 0);
    add_square(f.mesh, 0, 0, 0, 40, 20);
    add_square(f.mesh, 10, 5, 30, 10, 10);
    assert_int_equal(sim_canvas_new(WIDTH, HEIGHT, black, black, &f.canvas), 0);
    /* 60 mm high: a pixel is a millimetre in the middle. The viewer is far away, so that the sight
     * lines are nearly parallel. */
    const struct sim_view view = {.yaw_rad = yaw_rad, .distance_mm = 100000.0, .height_mm = HEIGHT};
    assert_int_equal(sim_scene_new(f.mesh, &view, f.canvas, &f.scene), 0);
    return f;
}

static void free_fixture(struct fixture f)
{
    sim_scene_free(f.scene);
    sim_canvas_free(f.canvas);
    iso_mesh_free(f.mesh);
}

/* Returns the canvas's sample at a place of the face's xy plane, seen from the front. */
static struct sim_colour at(const struct sim_canvas *canvas, double x_mm, double y_mm)
{
    long column = lrint((x_mm + 0.5 * WIDTH) * S), row = lrint((0.5 * HEIGHT - y_mm) * S);
    return canvas->sample[row * canvas->width + column];
}

static bool is_red(struct sim_colour c)
{
    return c.r > 0.99f && c.g < 0.01f;
}

static void test_shade_covers_the_mesh(void **state)
{
    (void)state;
    struct fixture f = new_fixture(0.0);
    const struct sim_colour colours[8] = {red, red, red, red, black, black, black, black};
    const struct sim_surface_style style = {.vertex = colours};
    assert_int_equal(sim_scene_shade(f.scene, &style), 0);
    struct sim_colour big = at(f.canvas, -15, -8), small = at(f.canvas, 10, 5);
    assert_true(big.r > 0.1f && big.r > big.g);
    assert_true(small.r < 0.15f); /* the black one is in front */
    assert_float_equal(at(f.canvas, -15, 15).r, 0.0, 0.0);
    assert_float_equal(at(f.canvas, 25, 0).r, 0.0, 0.0);
    free_fixture(f);
}

static void test_opacity(void **state)
{
    (void)state;
    struct fixture f = new_fixture(0.0);
    float opacity[8] = {-1.0f, -1.0f, -1.0f, -1.0f, 9.0f, 9.0f, 9.0f, 9.0f};
    const struct sim_surface_style style = {.base = {1.0f, 1.0f, 1.0f}, .opacity = opacity};
    assert_int_equal(sim_scene_shade(f.scene, &style), 0);
    assert_float_equal(at(f.canvas, -15, -8).g, 0.0, 0.0);
    assert_true(at(f.canvas, 10, 5).g > 0.1f);
    free_fixture(f);
}

static void test_dot_is_hidden_behind_a_surface(void **state)
{
    (void)state;
    struct fixture f = new_fixture(0.0);
    sim_scene_dot(f.scene, iso_vec3(-12, 6, 0), red, 2.0);
    sim_scene_dot(f.scene, iso_vec3(10, 5, 0), red, 2.0);  /* behind the small square */
    sim_scene_dot(f.scene, iso_vec3(500, 0, 0), red, 2.0); /* outside the picture */
    assert_true(is_red(at(f.canvas, -12, 6)));
    assert_true(is_red(at(f.canvas, -10.5, 6)));
    assert_false(is_red(at(f.canvas, -8, 6)));
    assert_false(is_red(at(f.canvas, 12, 6)));   /* not mirrored */
    assert_false(is_red(at(f.canvas, -12, -6))); /* not upside down */
    assert_false(is_red(at(f.canvas, 10, 5)));
    free_fixture(f);
}

static void test_viewer_to_the_left_sees_further(void **state)
{
    (void)state;
    /* Seen from the face's left (+x), a near point moves towards the face's right in the picture.
     */
    struct fixture f = new_fixture(0.3);
    sim_scene_dot(f.scene, iso_vec3(0, 0, 30), red, 2.0);
    assert_true(is_red(at(f.canvas, -30.0 * sin(0.3), 0)));
    free_fixture(f);
}

static void test_curve_is_round_and_has_gaps(void **state)
{
    (void)state;
    enum { N = 16 };
    struct fixture f = new_fixture(0.0);
    struct iso_vec3 points_mm[N];
    float weight[N];
    for (int i = 0; i < N; i++) {
        double angle = 2.0 * M_PI * i / N;
        points_mm[i] = iso_vec3(-8 + 6 * cos(angle), -2 + 6 * sin(angle), 0);
        weight[i] = i == 4 ? 0.0f : 1.0f; /* the topmost is missing */
    }
    sim_scene_curve(f.scene, points_mm, weight, N, red, 1.5);
    for (int i = 0; i < 64; i++) {
        double angle = 2.0 * M_PI * i / 64;
        struct sim_colour c = at(f.canvas, -8 + 6 * cos(angle), -2 + 6 * sin(angle));
        bool in_gap = i > 12 + 2 && i < 20 - 2, outside = i < 11 || i > 21;
        assert_false(in_gap && is_red(c));
        assert_true(!outside || is_red(c));
    }
    assert_false(is_red(at(f.canvas, -8, -2)));
    free_fixture(f);
}

static void test_refusals(void **state)
{
    (void)state;
    struct sim_canvas *canvas = NULL;
    assert_int_equal(sim_canvas_new(0, 10, black, black, &canvas), -EINVAL);
    assert_int_equal(sim_canvas_new(10, 5000, black, black, &canvas), -EINVAL);
    assert_null(canvas);
    struct fixture f = new_fixture(0.0);
    struct sim_scene *scene = NULL;
    f.mesh->n_triangles = 0;
    const struct sim_view view = {.distance_mm = 700.0, .height_mm = 200.0};
    assert_int_equal(sim_scene_new(f.mesh, &view, f.canvas, &scene), -EINVAL);
    assert_null(scene);
    free_fixture(f);
}

static void test_resolving_averages(void **state)
{
    (void)state;
    struct sim_canvas *canvas = NULL;
    assert_int_equal(sim_canvas_new(4, 3, black, black, &canvas), 0);
    for (int i = 0; i < S; i++) { /* a third of pixel (2, 1), in linear light */
        sim_canvas_blend(canvas, 2 * S + i, 1 * S, red, 1.0f);
    }
    cairo_surface_t *surface = sim_canvas_surface(canvas);
    const unsigned char *bytes = cairo_image_surface_get_data(surface);
    const unsigned char *row = bytes + cairo_image_surface_get_stride(surface);
    uint32_t pixel;
    memcpy(&pixel, row + 2 * sizeof pixel, sizeof pixel);
    assert_int_equal(pixel & 0xffffff, 0x9c0000); /* sRGB of 1/3 is 156 */
    cairo_surface_destroy(surface);
    sim_canvas_free(canvas);
}

static void test_plot_file(void **state)
{
    const double x[] = {1, 2, 3}, y[] = {20, 60, 90};
    const struct sim_series series = {"people", SIM_SERIES_MARKED, 3, x, y};
    const struct sim_plot plot = {"Title",
                                  NULL,
                                  SIM_LEGEND_LINE,
                                  {"x", SIM_SCALE_LINEAR, 1, 3},
                                  {"y", SIM_SCALE_LINEAR, 0, 100},
                                  1,
                                  &series};
    const char *path = scratch_path(*state, "plot.png");
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_plot_write(&plot, path, &fault), 0);
    struct iso_image image = {0};
    assert_int_equal(iso_png_read(path, NULL, &image, &fault), 0);
    assert_int_equal(image.width_px, 900);
    assert_int_equal(image.height_px, 640);
    iso_image_done(&image);
    path = scratch_path(*state, "missing/plot.png");
    assert_int_equal(sim_plot_write(&plot, path, &fault), -EIO);
    assert_non_null(strstr(fault.text, "missing/plot.png: "));
}

static void test_depth_file(void **state)
{
    const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                      .width_px = 8,
                                      .height_px = 240,
                                      .fx_px = 100,
                                      .fy_px = 100,
                                      .cx_px = 4,
                                      .cy_px = 120};
    struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_frame_new(&camera, 8, 240, false, &frame), 0);
    const char *path = scratch_path(*state, "depth.png");
    assert_int_equal(sim_picture_depth(frame, path, &fault), 0); /* nothing measured */
    for (int i = 0; i < 8 * 240; i++) {
        frame->depth_mm[i] = i % 8 < 4 ? 500.0f : 900.0f;
        if (i % 8 == 0) {
            frame->depth_mm[i] = 0.0f;
        }
    }
    assert_int_equal(sim_picture_depth(frame, path, &fault), 0);
    struct iso_image image = {0};
    assert_int_equal(iso_png_read(path, NULL, &image, &fault), 0);
    assert_int_equal(image.height_px, 480); /* doubled */
    const uint8_t *pixel = (const uint8_t *)image.samples +
                           (size_t)200 * iso_image_row_bytes(&image);
    assert_int_equal(pixel[0] + pixel[1] + pixel[2], 0);           /* not measured */
    assert_true(pixel[3 * 4 + 1] > 150 && pixel[3 * 4 + 2] < 100); /* near: yellow */
    assert_true(pixel[3 * 12 + 1] < 50 && pixel[3 * 12 + 2] > 40); /* far: violet */
    iso_image_done(&image);
    iso_frame_free(frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shade_covers_the_mesh),
        cmocka_unit_test(test_opacity),
        cmocka_unit_test(test_dot_is_hidden_behind_a_surface),
        cmocka_unit_test(test_viewer_to_the_left_sees_further),
        cmocka_unit_test(test_curve_is_round_and_has_gaps),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_resolving_averages),
        cmocka_unit_test_setup_teardown(test_plot_file, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_depth_file, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
