/* Stillness over frames: noise, sway, frozen frames, gaps. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/presentation/liveness.h"
#include "sim/base/random.h"

static const int64_t period_ns = 33333333;

/* Makes frame i. Its pose sways along x as a sine of 0.35 Hz with the amplitude sway_mm, and it has
 * noise. */
static struct iso_liveness_frame frame_at(int i, double sway_mm, double noise_mm,
                                          struct sim_random *random)
{
    struct iso_liveness_frame f = {.t_ns = 1000 + i * period_ns,
                                   .camera_from_face = iso_rigid_identity(),
                                   .sigma_mm = 2.0,
                                   .digest = (uint32_t)(1 + i)};
    double phase = 2.0 * M_PI * 0.35 * 1e-9 * (double)f.t_ns;
    double turn = noise_mm / 80.0 * sim_random_normal(random);
    f.camera_from_face.rotation = iso_mat3_rotation(iso_vec3(0.0, turn, 0.5 * turn));
    double x = noise_mm *
               sim_random_normal(random); /* one by one: a fixed order of the random numbers */
    double y = noise_mm * sim_random_normal(random);
    double z = 3.0 * noise_mm * sim_random_normal(random);
    f.camera_from_face.translation_mm = iso_vec3(sway_mm * sin(phase) + x, y, 600.0 + z);
    return f;
}

static enum iso_liveness_answer after(int n, double sway_mm, double noise_mm, uint64_t seed)
{
    struct sim_random random = sim_random_seeded(seed, 7, 0);
    const struct iso_liveness_options options = iso_liveness_options_default();
    struct iso_liveness l;
    enum iso_liveness_answer answer = ISO_LIVENESS_NOT_YET;
    iso_liveness_init(&options, &l);
    for (int i = 0; i < n; i++) {
        struct iso_liveness_frame f = frame_at(i, sway_mm, noise_mm, &random);
        answer = iso_liveness_feed(&l, &f);
    }
    return answer;
}

static void noise_is_still_and_sway_is_alive(void **state)
{
    (void)state;
    enum { TRIALS = 1000 };
    int still = 0, alive = 0;
    for (int k = 0; k < TRIALS; k++) {
        /* The smallest average that was ever measured on a person is 4.7 mm/s, which is 3.4 mm at
         * 0.35 Hz. This test requires half of it. */
        still += after(60, 0.0, 0.4, (uint64_t)k) == ISO_LIVENESS_STILL;
        alive += after(60, 1.7, 0.4, (uint64_t)k) == ISO_LIVENESS_ALIVE;
    }
    print_message("still %d, alive %d of %d\n", still, alive, TRIALS);
    assert_true(still >= 0.98 * TRIALS);
    assert_int_equal(alive, TRIALS);
}

static void a_short_visit_is_neither(void **state)
{
    (void)state;
    for (int n = 1; n <= 19; n++) {
        assert_int_equal(after(n, 0.0, 0.3, 3), ISO_LIVENESS_NOT_YET);
        assert_int_equal(after(n, 5.0, 0.3, 3), ISO_LIVENESS_NOT_YET);
    }
    assert_int_equal(after(30, 0.0, 0.3, 3), ISO_LIVENESS_NOT_YET); /* 1 s with noise alone */
    assert_int_equal(after(30, 5.0, 0.3, 3), ISO_LIVENESS_ALIVE);
}

static void frames_that_repeat_are_still_but_a_doubled_one_is_not(void **state)
{
    (void)state;
    const struct iso_liveness_options options = iso_liveness_options_default();
    struct sim_random random = sim_random_seeded(1, 2, 3);
    struct iso_liveness l;
    iso_liveness_init(&options, &l);
    for (int i = 0; i < 60; i++) { /* each frame twice, like a sensor of half the rate */
        struct iso_liveness_frame f = frame_at(i, 3.0, 0.3, &random);
        f.digest = (uint32_t)(i / 2);
        assert_int_not_equal(iso_liveness_feed(&l, &f), ISO_LIVENESS_STILL);
    }
    iso_liveness_init(&options, &l);
    for (int i = 0; i < 3; i++) {
        struct iso_liveness_frame f = frame_at(i, 3.0, 0.3, &random);
        f.digest = 9;
        assert_int_equal(iso_liveness_feed(&l, &f),
                         i < 2 ? ISO_LIVENESS_NOT_YET : ISO_LIVENESS_STILL);
    }
}

static void a_gap_begins_anew(void **state)
{
    (void)state;
    const struct iso_liveness_options options = iso_liveness_options_default();
    struct sim_random random = sim_random_seeded(4, 5, 6);
    for (int backwards = 0; backwards < 2; backwards++) {
        struct iso_liveness l;
        iso_liveness_init(&options, &l);
        enum iso_liveness_answer answer = ISO_LIVENESS_NOT_YET;
        for (int i = 0; i < 40; i++) {
            struct iso_liveness_frame f = frame_at(i, 4.0, 0.2, &random);
            answer = iso_liveness_feed(&l, &f);
        }
        assert_int_equal(answer, ISO_LIVENESS_ALIVE);
        struct iso_liveness_frame f = frame_at(backwards ? 38 : 60, 4.0, 0.2, &random);
        assert_int_equal(iso_liveness_feed(&l, &f), ISO_LIVENESS_NOT_YET);
        assert_int_equal(l.n, 1);
    }
}

static void the_digest_sees_the_face_and_no_more(void **state)
{
    (void)state;
    const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                      .width_px = 320,
                                      .height_px = 240,
                                      .fx_px = 300.0,
                                      .fy_px = 300.0,
                                      .cx_px = 150.0,
                                      .cy_px = 130.0};
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, 320, 240, false, &frame), 0);
    struct iso_vec3 nose = {0, 0, 600};
    uint32_t before = iso_liveness_digest(frame, nose);
    frame->depth_mm[5 * 320 + 5] = 700.0f; /* far from the face: 40 px to each side */
    assert_int_equal(iso_liveness_digest(frame, nose), before);
    frame->depth_mm[130 * 320 + 150] = 600.0f; /* row 130: every fourth row from 90 on counts */
    assert_int_not_equal(iso_liveness_digest(frame, nose), before);
    assert_int_equal(iso_liveness_digest(frame, iso_vec3(0, 0, -600)), 0);
    iso_frame_free(frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_still_and_sway_is_alive),
        cmocka_unit_test(a_short_visit_is_neither),
        cmocka_unit_test(frames_that_repeat_are_still_but_a_doubled_one_is_not),
        cmocka_unit_test(a_gap_begins_anew),
        cmocka_unit_test(the_digest_sees_the_face_and_no_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
