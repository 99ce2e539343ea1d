/* Sensor models at edges, shadows, hair and different distances: a card before a wall. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/sim/world/sensor_bench.h"

/* A card that is turned in its own plane. */
static void put(struct sensor_bench *b, double width_mm, double height_mm, double z_mm,
                double turn_rad, enum sim_material material)
{
    sensor_bench_put(b, width_mm, height_mm, z_mm, iso_vec3(0.0, 0.0, turn_rad), material);
}

static void shoot(struct sensor_bench *b, double noise_scale)
{
    struct sim_random random = sim_random_seeded(11, 0, 0);
    sim_view_finish(b->view);
    sim_sensor_measure(b->sensor, b->view, noise_scale, &random, b->workspace, b->frame);
}

/* Counts the pixels without a measurement to the left and right of the image's centre, in the
 * middle row. */
static void count_gaps(const struct sensor_bench *b, int *left, int *right)
{
    int width = b->frame->width_px, row = b->frame->height_px / 2;
    *left = *right = 0;
    for (int column = 0; column < width; column++) {
        if (!(iso_frame_depth_at(b->frame, column, row) > 0.0f)) {
            ++*(column < width / 2 ? left : right);
        }
    }
}

/* A card 100 mm wide at 500 mm before a wall at 1000 mm hides f b (1/500 - 1/1000) pixels from the
 * second eye. */
static void shadow_has_the_width_of_the_parallax(void **state)
{
    (void)state;
    static const struct {
        const struct sim_sensor *sensor;
        double focal_baseline;
        int at_right;
    } cases[] = {{&sim_sensor_astra, 575.8 * 75.0, 1}, {&sim_sensor_d435, 424.0 * 50.0, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct sensor_bench b = sensor_bench_set_up(cases[i].sensor);
        int left, right, parallax = (int)lrint(cases[i].focal_baseline * 0.001);
        sim_view_clear(b.view);
        put(&b, 3000.0, 2500.0, 1000.0, 0.0, SIM_WALL);
        put(&b, 100.0, 140.0, 500.0, 0.0, SIM_PAPER);
        shoot(&b, 0.0);
        count_gaps(&b, &left, &right);
        assert_true(abs((cases[i].at_right ? right : left) - parallax) <= 2);
        assert_int_equal(cases[i].at_right ? left : right, 0);
        sensor_bench_tear_down(&b);
    }
}

static void kinect2_pixels_fly_between(void **state)
{
    (void)state;
    struct sensor_bench b = sensor_bench_set_up(&sim_sensor_kinect2);
    int flying = 0;
    sim_view_clear(b.view);
    put(&b, 3000.0, 2500.0, 745.0, 0.0, SIM_WALL);
    put(&b, 200.0, 300.0, 700.0, 0.1, SIM_PAPER);
    shoot(&b, 0.0);
    for (int i = 0; i < 512 * 424; i++) {
        flying += b.frame->depth_mm[i] > 705.0f && b.frame->depth_mm[i] < 740.0f;
    }
    assert_true(flying > 50 && flying < 1000);
    sensor_bench_tear_down(&b);
}

static double share_missing(const struct sensor_bench *b)
{
    int missing = 0, n = 0;
    for (int row = 200; row < 280; row++) {
        for (int column = 220; column < 300; column++, n++) {
            missing += !(iso_frame_depth_at(b->frame, column, row) > 0.0f);
        }
    }
    return (double)missing / n;
}

static void hair_drops_out_and_skin_does_not(void **state)
{
    (void)state;
    struct sensor_bench b = sensor_bench_set_up(&sim_sensor_astra);
    for (int hair = 0; hair < 2; hair++) {
        sim_view_clear(b.view);
        put(&b, 3000.0, 2500.0, 600.0, 0.0, hair ? SIM_HAIR : SIM_SKIN);
        shoot(&b, 1.0);
        double missing = share_missing(&b);
        assert_true(hair ? missing > 0.01 && missing < 0.3 : missing <= 0.0);
    }
    sensor_bench_tear_down(&b);
}

static void out_of_range_is_not_measured(void **state)
{
    (void)state;
    static const struct {
        const struct sim_sensor *sensor;
        double z_mm;
        bool seen;
    } cases[] = {
        {&sim_sensor_astra, 300.0, false},     {&sim_sensor_astra, 400.0, true},
        {&sim_sensor_astra, 9000.0, false},    {&sim_sensor_kinect2, 450.0, false},
        {&sim_sensor_kinect2, 600.0, true},    {&sim_sensor_kinect2, 5000.0, false},
        {&sim_sensor_d435, 150.0, false},      {&sim_sensor_d435, 300.0, true},
        {&sim_sensor_truedepth, 120.0, false}, {&sim_sensor_truedepth, 4000.0, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct sensor_bench b = sensor_bench_set_up(cases[i].sensor);
        sim_view_clear(b.view);
        put(&b, 6.0 * cases[i].z_mm, 6.0 * cases[i].z_mm, cases[i].z_mm, 0.0, SIM_SKIN);
        shoot(&b, 0.0);
        int middle = b.frame->height_px / 2 * b.frame->width_px + b.frame->width_px / 2;
        assert_int_equal(b.frame->depth_mm[middle] > 0.0f, cases[i].seen);
        sensor_bench_tear_down(&b);
    }
}

/* The depth image has 255 levels from the nearest point on. It shows only skin, and nothing behind
 * it. */
static void texas_has_8_bits_of_face(void **state)
{
    (void)state;
    struct sensor_bench b = sensor_bench_set_up(&sim_sensor_texas);
    float nearest = 1e9f, farthest = 0.0f;
    bool cloth = false;
    sim_view_clear(b.view);
    put(&b, 40.0, 40.0, 650.0, 0.0, SIM_CLOTH);
    sensor_bench_put(&b, 600.0, 200.0, 700.0, iso_vec3(0.0, 1.2, 0.0), SIM_SKIN);
    shoot(&b, 0.0);
    for (int i = 0; i < 501 * 751; i++) {
        float z = b.frame->depth_mm[i];
        cloth = cloth || (b.view->material[i] == SIM_CLOTH && z > 0.0f);
        if (z > 0.0f) {
            nearest = fminf(nearest, z);
            farthest = fmaxf(farthest, z);
            assert_true(fabs(remainder((double)z, 0.4)) < 1e-3);
        }
    }
    assert_false(cloth);
    assert_true(farthest - nearest > 90.0f && farthest - nearest <= 255 * 0.4f + 0.2f);
    sensor_bench_tear_down(&b);
}

static void sensors_are_found_by_name(void **state)
{
    (void)state;
    assert_ptr_equal(sim_sensor_find("kinect2"), &sim_sensor_kinect2);
    assert_null(sim_sensor_find("kinect"));
    for (int i = 0; sim_sensors[i]; i++) {
        assert_int_equal(iso_camera_check(&sim_sensors[i]->camera, NULL), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shadow_has_the_width_of_the_parallax),
        cmocka_unit_test(kinect2_pixels_fly_between),
        cmocka_unit_test(hair_drops_out_and_skin_does_not),
        cmocka_unit_test(out_of_range_is_not_measured),
        cmocka_unit_test(texas_has_8_bits_of_face),
        cmocka_unit_test(sensors_are_found_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
