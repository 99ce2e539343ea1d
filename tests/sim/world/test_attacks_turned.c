/* The instruments of the preset `attacks-turned` are turned as far as they should be. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "sim/world/generate/staging.h"
#include "tests/sim/world/generated.h"
#include "tests/support/scratch.h"

static const double degree_rad = 0.017453292519943295;

/* Over many draws, yaw fills both ranges and pitch its own; an instrument that is not turned away
 * keeps to the limits of its kind. */
static void angles_fill_their_ranges(void **state)
{
    (void)state;
    struct sim_random random = sim_random_seeded(1, 2, 3);
    struct sim_staging staging = {.random = &random};
    const struct sim_turn turn = {
        .away = true, .yaw_least_deg = 25.0, .yaw_most_deg = 40.0, .pitch_most_deg = 30.0};
    double least = 1e9, most = 0.0, highest = 0.0;
    int left = 0;
    for (int i = 0; i < 1000; i++) {
        staging.turn = (struct sim_turn){0};
        assert_true(fabs(sim_staging_yaw(&staging, 10.0)) <= 10.0 * degree_rad);
        assert_true(fabs(sim_staging_pitch(&staging, 5.0)) <= 5.0 * degree_rad);
        staging.turn = turn;
        const double yaw = sim_staging_yaw(&staging, 10.0) / degree_rad;
        const double pitch = sim_staging_pitch(&staging, 5.0) / degree_rad;
        least = fmin(least, fabs(yaw));
        most = fmax(most, fabs(yaw));
        highest = fmax(highest, fabs(pitch));
        left += yaw < 0.0;
    }
    assert_true(least >= 25.0 && least < 26.0 && most <= 40.0 && most > 39.0);
    assert_true(highest <= 30.0 && highest > 29.0);
    assert_in_range(left, 400, 600);
}

/* A flat print: yaw and pitch of its normal, in degrees, from a plane through the middle. */
static void slopes(const struct iso_frame *frame, double *yaw_deg, double *pitch_deg)
{
    const int half_px = 18;
    double a[6][7] = {{0}};
    for (int v = -half_px; v <= half_px; v++) {
        for (int u = -half_px; u <= half_px; u++) {
            struct iso_vec3 p = generated_point(frame, frame->width_px / 2 + u,
                                                frame->height_px / 2 + v);
            const double terms[3] = {1.0, p.x, p.y};
            for (int r = 0; p.z > 0.0 && r < 3; r++) {
                for (int c = 0; c < 3; c++) {
                    a[r][c] += terms[r] * terms[c];
                }
                a[r][6] += terms[r] * p.z;
            }
        }
    }
    generated_solve(a, 3);
    *yaw_deg = fabs(atan(a[1][6])) / degree_rad;
    *pitch_deg = fabs(atan(a[2][6])) / degree_rad;
}

/* Yaw and pitch are one rotation about one axis, so that the slopes differ from both by some
 * degrees. The kind `photo-flat` of the preset `attacks` has a yaw of 20 degrees at most. */
static void flat_prints_are_turned_away(void **state)
{
    struct sim_generate_options options = generated_options("attacks-turned",
                                                            scratch_path(*state, "turned"));
    options.sensor = &sim_sensor_truedepth;
    options.noise_scale = 0.0;
    options.n_people = 1;
    options.n_per_kind = 4;
    options.frames_per_visit = 2;
    sim_corpus_free(generated_corpus(&options));
    for (int i = 0; i < options.n_per_kind; i++) {
        char name[64];
        double yaw_deg, pitch_deg;
        (void)snprintf(name, sizeof name, "none-photo-flat-%04d", i);
        struct iso_frame *frame = generated_frame(options.directory, name, 0);
        slopes(frame, &yaw_deg, &pitch_deg);
        iso_frame_free(frame);
        print_message("%s: slopes of %.1f and %.1f degrees\n", name, yaw_deg, pitch_deg);
        assert_true(yaw_deg > 20.0 && yaw_deg < 50.0 && pitch_deg < 45.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_fill_their_ranges),
        cmocka_unit_test(flat_prints_are_turned_away),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
