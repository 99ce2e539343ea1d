/* The noise of each sensor model on a plane, compared with the figure from which the model was
 * made. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/sim/world/sensor_bench.h"

struct measurement {
    double sd_mm, mean_mm;
    double correlation; /* correlation of errors one pixel apart */
    int missing;
};

/* A plane of skin that fills the image. It is slanted, so that it crosses many quantisation steps.
 */
static void look_at_plane(struct sensor_bench *b, double z_mm, double slant_rad)
{
    sim_view_clear(b->view);
    sensor_bench_put(b, 6.0 * z_mm, 6.0 * z_mm, z_mm, iso_vec3(0.5 * slant_rad, slant_rad, 0.0),
                     SIM_SKIN);
    sim_view_finish(b->view);
}

/* The mean depth of the view's samples in a pixel. */
static double true_depth(const struct sim_view *view, int column, int row)
{
    int s = view->supersample;
    double sum = 0.0;
    for (int k = 0; k < s * s; k++) {
        sum += (double)view->depth_mm[(size_t)(row * s + k / s) * (size_t)view->camera.width_px +
                                      (size_t)(column * s + k % s)];
    }
    return sum / (s * s);
}

/* Statistics of measured - true over the central 160 x 140 pixels. */
static struct measurement measure(struct sensor_bench *b, double noise_scale, uint64_t seed)
{
    struct sim_random random = sim_random_seeded(seed, 0, 0);
    struct measurement m = {0};
    double sum = 0.0, squares = 0.0, lagged = 0.0, before = 0.0;
    int n = 0, pairs = 0;
    sim_sensor_measure(b->sensor, b->view, noise_scale, &random, b->workspace, b->frame);
    int left = b->frame->width_px / 2 - 80, top = b->frame->height_px / 2 - 70;
    for (int row = top; row < top + 140; row++) {
        for (int column = left; column < left + 160; column++) {
            double z = (double)iso_frame_depth_at(b->frame, column, row);
            double error = z - true_depth(b->view, column, row);
            if (!(z > 0.0)) {
                m.missing++;
                continue;
            }
            sum += error;
            squares += error * error;
            n++;
            if (column > left) {
                lagged += error * before;
                pairs++;
            }
            before = error;
        }
    }
    m.mean_mm = sum / n;
    double variance = squares / n - m.mean_mm * m.mean_mm;
    m.sd_mm = sqrt(variance);
    m.correlation = (lagged / pairs - m.mean_mm * m.mean_mm) / variance;
    return m;
}

static const struct figure {
    const struct sim_sensor *sensor;
    double z_mm, least_mm, most_mm, bias_mm;
    const char *published;
} figures[] = {
    {&sim_sensor_astra, 600.0, 0.51, 1.28, 0.4, "0.51 (Khoshelham 2012) .. 1.28 mm (Nguyen 2012)"},
    {&sim_sensor_astra, 1000.0, 1.42, 2.2, 0.4, "1.42 (Khoshelham 2012) .. 1.88 mm (Nguyen 2012)"},
    {&sim_sensor_kinect2, 800.0, 0.85, 1.25, 8.0, "about 1 mm (Sarbolandi 2015)"},
    {&sim_sensor_kinect2_coarse, 800.0, 1.5, 2.5, 8.0,
     "at least 1.5 mm (Corti 2016), steps of 4 mm"},
    {&sim_sensor_d435, 600.0, 1.2, 1.6, 0.2, "1.36 mm: 0.08 px (Intel tuning guide)"},
    {&sim_sensor_truedepth, 400.0, 0.34, 0.46, 0.1,
     "0.4 mm assumed; \"mm range\" (Breitbarth 2019)"},
    {&sim_sensor_texas, 600.0, 0.22, 0.34, 0.1, "0.25 mm assumed, 0.4 mm levels"},
};

static void noise_is_as_published(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof figures / sizeof *figures; i++) {
        const struct figure *f = &figures[i];
        struct sensor_bench b = sensor_bench_set_up(f->sensor);
        look_at_plane(&b, f->z_mm, 0.2);
        struct measurement m = measure(&b, 1.0, 1);
        print_message("%-10s %5.0f mm: sd %.2f mm, bias %+.2f mm; published: %s\n", f->sensor->name,
                      f->z_mm, m.sd_mm, m.mean_mm, f->published);
        assert_int_equal(m.missing, 0);
        assert_true(m.sd_mm > f->least_mm && m.sd_mm < f->most_mm);
        assert_true(fabs(m.mean_mm) < f->bias_mm);
        sensor_bench_tear_down(&b);
    }
}

/* Sensors that compare windows have errors that neighbours share. The pixels of a time-of-flight
 * sensor are independent. */
static void windows_correlate_neighbours(void **state)
{
    (void)state;
    for (int i = 0; sim_sensors[i]; i++) {
        if (sim_sensors[i]->attach) {
            continue; /* its noise has its own test: test_stereo_sensor.c */
        }
        struct sensor_bench b = sensor_bench_set_up(sim_sensors[i]);
        look_at_plane(&b, 900.0, 0.2);
        double correlation = measure(&b, 1.0, 2).correlation;
        if (sim_sensors[i] == &sim_sensor_kinect2) {
            assert_true(correlation < 0.4);
        } else {
            assert_true(correlation > 0.5);
        }
        sensor_bench_tear_down(&b);
    }
}

static void noise_scales_and_leaves_the_quantum(void **state)
{
    (void)state;
    for (int i = 0; sim_sensors[i]; i++) {
        if (sim_sensors[i]->attach) {
            continue; /* its noise has its own test: test_stereo_sensor.c */
        }
        struct sensor_bench b = sensor_bench_set_up(sim_sensors[i]);
        look_at_plane(&b, 600.0, 0.2);
        double none = measure(&b, 0.0, 3).sd_mm, twice = measure(&b, 2.0, 3).sd_mm;
        double once = measure(&b, 1.0, 3).sd_mm;
        double expected = sqrt(once * once + 3.0 * (once * once - none * none));
        /* Steps of 4 mm are a larger part of an error. */
        const double most = sim_sensors[i] == &sim_sensor_kinect2_coarse ? 0.75 : 0.6;
        assert_true(none > 0.0 && none < most * once);
        assert_true(fabs(twice - expected) < 0.1 * expected);
        sensor_bench_tear_down(&b);
    }
}

static void noise_grows_with_distance_and_slant(void **state)
{
    (void)state;
    static const struct sim_sensor *const real[] = {&sim_sensor_astra, &sim_sensor_kinect2,
                                                    &sim_sensor_d435, &sim_sensor_truedepth};
    for (size_t i = 0; i < sizeof real / sizeof *real; i++) {
        struct sensor_bench b = sensor_bench_set_up(real[i]);
        look_at_plane(&b, 600.0, 0.2);
        double near = measure(&b, 1.0, 4).sd_mm;
        look_at_plane(&b, 1200.0, 0.2);
        double far = measure(&b, 1.0, 4).sd_mm;
        look_at_plane(&b, 600.0, 1.0);
        double slanted = measure(&b, 1.0, 4).sd_mm;
        assert_true(far > 2.0 * near &&
                    far < 6.0 * near); /* z^2, except for the part that does not grow */
        assert_true(slanted > 1.1 * near);
        sensor_bench_tear_down(&b);
    }
}

static void seeds_repeat_and_differ(void **state)
{
    (void)state;
    struct sensor_bench b = sensor_bench_set_up(&sim_sensor_d435);
    look_at_plane(&b, 700.0, 0.2);
    double first = measure(&b, 1.0, 5).mean_mm;
    assert_true(fabs(measure(&b, 1.0, 5).mean_mm - first) <= 0.0);
    assert_true(fabs(measure(&b, 1.0, 6).mean_mm - first) > 0.0);
    sensor_bench_tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_as_published),
        cmocka_unit_test(windows_correlate_neighbours),
        cmocka_unit_test(noise_scales_and_leaves_the_quantum),
        cmocka_unit_test(noise_grows_with_distance_and_slant),
        cmocka_unit_test(seeds_repeat_and_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
