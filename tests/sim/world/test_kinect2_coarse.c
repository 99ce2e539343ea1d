/* The time-of-flight sensor with steps, flying pixels and multipath. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "sim/world/sensor/multipath.h"
#include "tests/sim/world/sensor_bench.h"

enum { WIDTH = 512, HEIGHT = 424, PIXELS = WIDTH * HEIGHT };

static const struct iso_vec3 straight = {0.0, 0.0, 0.0};

/* Measures the scene in the view as the first frame of recording number `recording`, and as its
 * second frame if `second` is not NULL. */
static void shoot(struct sensor_bench *b, uint64_t recording, double noise_scale, float *second)
{
    struct sim_random random = sim_random_seeded(recording, 3, 0);
    sim_view_finish(b->view);
    sim_sensor_begin(b->workspace, &random);
    sim_sensor_measure(b->sensor, b->view, noise_scale, &random, b->workspace, b->frame);
    if (second) {
        memcpy(second, b->frame->depth_mm, PIXELS * sizeof *second);
        sim_sensor_measure(b->sensor, b->view, noise_scale, &random, b->workspace, b->frame);
    }
}

/* Whether all depths that were measured are multiples of a step. */
static bool is_in_steps(const float *depth_mm, int step_mm)
{
    for (int i = 0; i < PIXELS; i++) {
        if ((int)depth_mm[i] % step_mm != 0) {
            return false;
        }
    }
    return true;
}

/* The largest step, mm, that all depths are multiples of. */
static int step_of(const float *depth_mm)
{
    int step_mm = 12;
    while (!is_in_steps(depth_mm, step_mm)) {
        step_mm--;
    }
    return step_mm;
}

static void put_slanted_plane(struct sensor_bench *b)
{
    sim_view_clear(b->view);
    sensor_bench_put(b, 5000.0, 4000.0, 800.0, iso_vec3(0.1, 0.2, 0.0), SIM_SKIN);
}

static void depths_come_in_steps_that_stay_during_a_recording(void **state)
{
    (void)state;
    static float first[PIXELS];
    struct sensor_bench b = sensor_bench_set_up(&sim_sensor_kinect2_coarse);
    int seen[13] = {0};
    for (uint64_t recording = 0; recording < 16; recording++) {
        put_slanted_plane(&b);
        shoot(&b, recording, 1.0, first);
        const int step_mm = step_of(first);
        assert_in_range(step_mm, 1, 8);
        assert_int_equal(step_of(b.frame->depth_mm), step_mm);
        assert_memory_not_equal(first, b.frame->depth_mm, sizeof first);
        seen[step_mm]++;
    }
    print_message("recordings with steps of 1 to 8 mm: %d %d %d %d %d %d %d %d of 16\n", seen[1],
                  seen[2], seen[3], seen[4], seen[5], seen[6], seen[7], seen[8]);
    assert_true(seen[1] + seen[2] + seen[3] > 0 && seen[6] + seen[7] + seen[8] > 0);
    sensor_bench_tear_down(&b);
}

static void the_same_seed_makes_the_same_frame(void **state)
{
    (void)state;
    static float first[PIXELS];
    struct sensor_bench b = sensor_bench_set_up(&sim_sensor_kinect2_coarse);
    put_slanted_plane(&b);
    shoot(&b, 7, 1.0, NULL);
    memcpy(first, b.frame->depth_mm, sizeof first);
    shoot(&b, 8, 1.0, NULL);
    assert_memory_not_equal(first, b.frame->depth_mm, sizeof first);
    shoot(&b, 7, 1.0, NULL);
    assert_memory_equal(first, b.frame->depth_mm, sizeof first);
    sensor_bench_tear_down(&b);
}

/* Without noise every depth lies between card and wall, and those in between are on the outline of
 * the card. */
static void pixels_fly_between_card_and_wall_only(void **state)
{
    (void)state;
    struct sensor_bench b = sensor_bench_set_up(&sim_sensor_kinect2_coarse);
    const double half_u = 100.0 * 365.0 / 700.0, half_v = 150.0 * 365.0 / 700.0;
    const float step_mm = 8.0f;
    int flying = 0;
    sim_view_clear(b.view);
    sensor_bench_put(&b, 3000.0, 2500.0, 745.0, straight, SIM_WALL);
    sensor_bench_put(&b, 200.0, 300.0, 700.0, straight, SIM_PAPER);
    shoot(&b, 5, 0.0, NULL);
    for (int i = 0; i < PIXELS; i++) {
        const float z = b.frame->depth_mm[i];
        const double u = fabs(i % WIDTH - 255.5), v = fabs(i / WIDTH - 211.5);
        assert_true(z >= 700.0f - step_mm && z <= 745.0f + step_mm);
        if (z > 700.0f + step_mm && z < 745.0f - step_mm) {
            flying++;
            assert_true(fabs(u - half_u) <= 2.0 || fabs(v - half_v) <= 2.0);
        }
    }
    print_message("%d flying pixels\n", flying);
    assert_in_range(flying, 200, 2000);
    sensor_bench_tear_down(&b);
}

/* The errors of a surface z = 800 + bend * (distance from the middle)^2 + slant * column. */
static const float *errors_of(double bend, double slant)
{
    static float depth_mm[PIXELS], cells[PIXELS], error_mm[PIXELS];
    const struct sim_multipath model = {0.4, 6.0, 4, 60.0};
    for (int i = 0; i < PIXELS; i++) {
        const double u = i % WIDTH - 255.5, v = i / WIDTH - 211.5;
        depth_mm[i] = (float)(800.0 + bend * (u * u + v * v) + slant * u);
    }
    sim_multipath_errors(&model, depth_mm, WIDTH, HEIGHT, cells, error_mm);
    return error_mm;
}

static float middle_of(const float *error_mm)
{
    return error_mm[212 * WIDTH + 256];
}

/* A hollow looks deeper, by no more than the limit and without jumps. A plane and a bulge have no
 * error. */
static void light_arrives_late_in_hollows_only(void **state)
{
    (void)state;
    assert_true(fabsf(middle_of(errors_of(0.0, 0.0))) < 1e-3f);
    assert_true(fabsf(middle_of(errors_of(0.0, 1.0))) < 1e-3f);
    assert_true(fabsf(middle_of(errors_of(0.02, 0.0))) < 1e-3f);
    const float shallow = middle_of(errors_of(-0.005, 0.0));
    assert_true(shallow > 0.1f);
    const float *deep = errors_of(-0.02, 0.0);
    print_message("hollows: %.2f and %.2f mm\n", (double)shallow, (double)middle_of(deep));
    assert_true(middle_of(deep) > 2.0f * shallow && middle_of(deep) <= 6.0f);
    for (int u = 200; u < 300; u++) {
        assert_true(fabsf(deep[212 * WIDTH + u + 1] - deep[212 * WIDTH + u]) < 0.1f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depths_come_in_steps_that_stay_during_a_recording),
        cmocka_unit_test(the_same_seed_makes_the_same_frame),
        cmocka_unit_test(pixels_fly_between_card_and_wall_only),
        cmocka_unit_test(light_arrives_late_in_hollows_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
