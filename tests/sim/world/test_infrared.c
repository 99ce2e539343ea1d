/* The infrared image of a sensor: Lambert's cosine, the decrease with the distance, noise, counts,
 * and prints. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "sim/world/prop/print.h"
#include "sim/world/sensor/sensor.h"

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

/* A sensor with a predictable image: a white card at 1 m that faces it has the value 0.5. */
static struct sim_sensor plain_sensor(void)
{
    return (struct sim_sensor){
        .name = "plain",
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = WIDTH,
                   .height_px = HEIGHT,
                   .fx_px = 60.0,
                   .fy_px = 50.0,
                   .cx_px = 30.0,
                   .cy_px = 20.0},
        .unit_mm = 1.0,
        .supersample = 2,
        .infrared = {.level = 0.5, .bits = 16},
    };
}

/* The image of a sheet that fills the view, with one albedo or with that of paper (0). */
static void shoot(const struct sim_sensor *sensor, double z_mm, double turn_rad, float albedo,
                  uint64_t seed, float image[PIXELS])
{
    struct sim_sensor_workspace *workspace;
    struct sim_view *view;
    struct sim_solid *sheet;
    struct iso_vec3 scratch[4];
    struct iso_rigid placed = {iso_mat3_rotation(iso_vec3(0.0, turn_rad, 0.0)), {0.0, 0.0, z_mm}};
    struct sim_random random = sim_random_seeded(seed, 0, 0);
    assert_int_equal(sim_view_new(&sensor->camera, sensor->supersample, &view), 0);
    assert_int_equal(sim_sensor_workspace_new(sensor, &workspace), 0);
    assert_int_equal(
        sim_print_new(1.7 * z_mm, 1.7 * z_mm, 0.0, albedo > 0.0F ? &albedo : NULL, 1, 1, &sheet),
        0);
    assert_int_equal(sim_solid_draw(sheet, &placed, scratch, view), 0);
    sim_view_finish(view);
    sim_infrared_measure(sensor, view, 1.0, &random, workspace, image);
    sim_solid_free(sheet);
    sim_sensor_workspace_free(workspace);
    sim_view_free(view);
}

static double pixel(const float image[PIXELS], int column, int row)
{
    return (double)image[row * WIDTH + column];
}

static void light_falls_with_slant_and_distance(void **state)
{
    static float image[PIXELS];
    const struct sim_sensor sensor = plain_sensor();
    (void)state;
    shoot(&sensor, 1000.0, 0.0, 1.0F, 1, image);
    assert_true(fabs(pixel(image, 30, 20) - 0.5) < 1e-3);
    /* At (u, v) = (55, 20) the sight line has x / z = 25 / 60: its cosine is c and the range is 1 m
     * / c. */
    double c = 1.0 / sqrt(1.0 + 25.0 * 25.0 / 3600.0);
    assert_true(fabs(pixel(image, 55, 20) - 0.5 * c * c * c) < 1e-3);
    shoot(&sensor, 2000.0, 0.0, 1.0F, 1, image);
    assert_true(fabs(pixel(image, 30, 20) - 0.125) < 1e-3);
    shoot(&sensor, 1000.0, 1.0, 0.4F, 1, image);
    assert_true(fabs(pixel(image, 30, 20) - 0.4 * 0.5 * cos(1.0)) < 1e-3);
    shoot(&sensor, 1000.0, 0.0, 0.0F, 1, image); /* plain paper */
    assert_true(fabs(pixel(image, 30, 20) - 0.8 * 0.5) < 1e-3);
}

static void light_of_the_room_does_not_fall(void **state)
{
    static float image[PIXELS];
    struct sim_sensor sensor = plain_sensor();
    (void)state;
    sensor.infrared.ambient = true;
    shoot(&sensor, 2000.0, 0.0, 1.0F, 1, image);
    assert_true(fabs(pixel(image, 30, 20) - 0.5) < 1e-3);
}

/* Counts are whole numbers, and no pixel is brighter than full scale. */
static void values_are_counts(void **state)
{
    static float image[PIXELS];
    struct sim_sensor sensor = plain_sensor();
    (void)state;
    sensor.infrared.bits = 4;
    shoot(&sensor, 1000.0, 0.0, 1.0F, 1, image);
    for (int i = 0; i < PIXELS; i++) {
        double counts = 15.0 * (double)image[i];
        assert_true(fabs(counts - nearbyint(counts)) < 1e-5);
    }
    shoot(&sensor, 300.0, 0.0, 1.0F, 1, image);
    assert_true(pixel(image, 30, 20) >= 1.0 && pixel(image, 30, 20) <= 1.0);
}

/* The standard deviation from the noiseless image, over all its pixels. */
static double deviation(const float noisy[PIXELS], const float clean[PIXELS])
{
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        double d = (double)noisy[i] - (double)clean[i];
        sum += d * d;
    }
    return sqrt(sum / PIXELS);
}

static void noise_is_as_stated(void **state)
{
    static float clean[PIXELS], noisy[PIXELS], again[PIXELS];
    struct sim_sensor sensor = plain_sensor();
    (void)state;
    sensor.infrared.ambient = true; /* every pixel near 0.25 */
    shoot(&sensor, 1000.0, 0.0, 0.5F, 1, clean);
    sensor.infrared.shot = 4e-4;
    sensor.infrared.dark = 5e-3;
    shoot(&sensor, 1000.0, 0.0, 0.5F, 5, noisy);
    shoot(&sensor, 1000.0, 0.0, 0.5F, 5, again);
    double mean = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        mean += (double)clean[i] / PIXELS;
        assert_true(noisy[i] >= again[i] && noisy[i] <= again[i]); /* the same seed */
    }
    double expected = sqrt(4e-4 * mean + 25e-6), found = deviation(noisy, clean);
    print_message("noise %.5f, expected %.5f\n", found, expected);
    assert_true(fabs(found / expected - 1.0) < 4.0 / sqrt(2.0 * PIXELS)); /* 4 sigma */
}

/* A projector concentrates light into dots. The total light stays the same. */
static void dots_keep_the_mean(void **state)
{
    static float clean[PIXELS], dotted[PIXELS];
    struct sim_sensor sensor = plain_sensor();
    (void)state;
    sensor.infrared.level = 0.1;
    sensor.infrared.ambient = true;
    shoot(&sensor, 1000.0, 0.0, 1.0F, 1, clean);
    sensor.infrared.dots = 0.7;
    shoot(&sensor, 1000.0, 0.0, 1.0F, 3, dotted);
    double mean = 0.0, expected = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        mean += (double)dotted[i] / PIXELS;
        expected += (double)clean[i] / PIXELS;
    }
    /* The deviation of a single pixel is 0.7 x sqrt(0.9 / 0.1) = 2.1 means, before the lens blurs
     * it. */
    assert_true(fabs(mean / expected - 1.0) < 4.0 * 2.1 / sqrt(PIXELS));
    assert_true(deviation(dotted, clean) > 0.5 * expected);
}

static void a_print_shows_its_picture(void **state)
{
    static float image[PIXELS];
    const struct sim_sensor sensor = plain_sensor();
    struct sim_sensor_workspace *workspace;
    struct sim_view *view;
    struct sim_solid *sheet;
    struct iso_vec3 scratch[12];
    struct sim_random random = sim_random_seeded(1, 0, 0);
    const float picture[6] = {0.9F, 0.5F, 0.1F, 0.2F, 0.7F, 0.3F}; /* 3 x 2, rows from the top */
    struct iso_rigid placed = {iso_mat3_identity(), {0.0, 0.0, 1000.0}};
    (void)state;
    assert_int_equal(sim_view_new(&sensor.camera, sensor.supersample, &view), 0);
    assert_int_equal(sim_sensor_workspace_new(&sensor, &workspace), 0);
    assert_int_equal(sim_print_new(600.0, 400.0, 0.0, picture, 3, 2, &sheet), 0);
    assert_int_equal(sim_solid_draw(sheet, &placed, scratch, view), 0);
    sim_view_finish(view);
    sim_infrared_measure(&sensor, view, 1.0, &random, workspace, image);
    for (int k = 0; k < 6; k++) { /* the middle of each of its pixels */
        double x = 0.2 * (k % 3 - 1), y = 0.2 * (k / 3) - 0.1;
        int column = (int)nearbyint(30.0 + 60.0 * x), row = (int)nearbyint(20.0 + 50.0 * y);
        double r2 = 1.0 + x * x + y * y;
        double expected = 0.5 * (double)picture[k] / (r2 * sqrt(r2));
        assert_true(fabs(pixel(image, column, row) - expected) < 0.01);
    }
    sim_solid_free(sheet);
    sim_sensor_workspace_free(workspace);
    sim_view_free(view);
}

static void prints_of_no_size_are_refused(void **state)
{
    struct sim_solid *sheet = NULL;
    (void)state;
    assert_int_equal(sim_print_new(0.0, 10.0, 0.0, NULL, 1, 1, &sheet), -EINVAL);
    assert_int_equal(sim_print_new(10.0, 10.0, -1.0, NULL, 1, 1, &sheet), -EINVAL);
    assert_int_equal(sim_print_new(10.0, 10.0, 0.0, NULL, 0, 1, &sheet), -EINVAL);
    assert_int_equal(sim_print_new(10.0, 10.0, 0.0, NULL, 1, 2001, &sheet), -EINVAL);
    assert_null(sheet);
}

/* The image of every simulated sensor is neither black nor white at the place of use. */
static void every_sensor_has_an_image(void **state)
{
    (void)state;
    for (int s = 0; sim_sensors[s]; s++) {
        const struct sim_sensor *sensor = sim_sensors[s];
        const struct sim_infrared *ir = &sensor->infrared;
        if (sensor->picture) {
            continue; /* takes one: test_stereo_sensor.c */
        }
        double far = 1e-3 * sensor->distance_max_mm, near = 1e-3 * sensor->distance_min_mm;
        double least = 0.5 * ir->level / (ir->ambient ? 1.0 : far * far);
        double most = 0.65 * ir->level / (ir->ambient ? 1.0 : near * near);
        assert_in_range(ir->bits, 8, 16);
        assert_true(least > 8.0 / (double)(1 << ir->bits) && least > 4.0 * ir->dark);
        assert_true(most < 1.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_falls_with_slant_and_distance),
        cmocka_unit_test(light_of_the_room_does_not_fall),
        cmocka_unit_test(values_are_counts),
        cmocka_unit_test(noise_is_as_stated),
        cmocka_unit_test(dots_keep_the_mean),
        cmocka_unit_test(a_print_shows_its_picture),
        cmocka_unit_test(prints_of_no_size_are_refused),
        cmocka_unit_test(every_sensor_has_an_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
