/* Many points compared at once have the results of points compared one by one, to the bit, on each
 * kind of processor. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/landmark/meet_many.h"
#include "core/landmark/meeting.h"

enum { WIDTH = 37, HEIGHT = 29, ROUNDS = 400, CORNERS_OF_FRAME = 4 };

static const double distance_mm = 600.0;

/* The next number of a fixed sequence in -1..1. */
static double next(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / (double)(UINT64_C(1) << 52) - 1.0;
}

/* A slanted plane with steps and with pixels that were not measured, cut out of a larger image. */
static struct iso_frame *new_frame(void)
{
    const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                      .width_px = 80,
                                      .height_px = 60,
                                      .fx_px = 71.0,
                                      .fy_px = 73.0,
                                      .cx_px = 41.3,
                                      .cy_px = 29.6};
    struct iso_frame *frame = NULL;
    uint64_t state = 5;
    assert_int_equal(iso_frame_new(&camera, WIDTH, HEIGHT, false, &frame), 0);
    frame->crop_x_px = 22;
    frame->crop_y_px = 15;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const double chance = next(&state), noise = next(&state);
        const double step = chance > 0.6 ? 30.0 : 0.0;
        frame->depth_mm[i] = chance < -0.7 ? 0.0f
                                           : (float)(distance_mm + i % WIDTH + step + 3.0 * noise);
    }
    return frame;
}

/* Points within some 250 mm, so that some of them lie outside the frame, with any normals. The
 * first ones appear at the corners of the frame, beyond the centres of the last pixels. */
static void make_points(const struct iso_frame *frame, const struct iso_rigid *pose,
                        uint64_t *state, struct iso_meet_points *points)
{
    const struct iso_rigid face_from_camera = iso_rigid_inverse(pose);
    const struct iso_camera *c = &frame->camera;
    for (int i = 0; i < ISO_MEET_MANY; i++) {
        struct iso_vec3 p = iso_vec3(250.0 * next(state), 200.0 * next(state),
                                     distance_mm + 40.0 * next(state));
        struct iso_vec3 n = iso_unit(iso_vec3(next(state), next(state), next(state) - 0.8));
        if (i < CORNERS_OF_FRAME) {
            const double u = frame->crop_x_px + (i % 2 == 0 ? 0.2 : WIDTH - 1 + 0.4);
            const double v = frame->crop_y_px + (i < 2 ? 0.1 : HEIGHT - 1 + 0.3);
            p = iso_vec3(p.z * (u - c->cx_px) / c->fx_px, p.z * (v - c->cy_px) / c->fy_px, p.z);
            n = iso_vec3(0.0, 0.0, -1.0);
        }
        iso_meet_points_set(points, i, iso_rigid_apply(&face_from_camera, p),
                            iso_mat3_apply(&face_from_camera.rotation, n));
    }
}

/* The bits of the first n entries. On arm64 the compiler may round some products once less. */
static void check_same(const double *a, const double *b, int n)
{
#if defined __x86_64__
    assert_memory_equal(a, b, (size_t)n * sizeof *a);
#else
    for (int i = 0; i < n; i++) {
        assert_true(fabs(a[i] - b[i]) <= 1e-9);
    }
#endif
}

static void check_equal(const struct iso_meetings *a, const struct iso_meetings *b, int n)
{
    for (int axis = 0; axis < 3; axis++) {
        check_same(a->normal[axis], b->normal[axis], n);
        check_same(a->turn_mm[axis], b->turn_mm[axis], n);
    }
    check_same(a->distance_mm, b->distance_mm, n);
    check_same(a->weight, b->weight, n);
    for (int i = 0; i < n; i++) {
        assert_int_equal(a->meeting[i], b->meeting[i]);
    }
}

/* Compares one round of points in each way. Adds up how often each meeting occurs. */
static void check_round(const struct iso_frame *frame, uint64_t *state, int n,
                        int count[ISO_MEETINGS])
{
    const double cutoff_mm = 25.0;
    const struct iso_vec3 turn = iso_vec3(next(state), next(state), next(state));
    const struct iso_rigid pose = {iso_mat3_rotation(turn), {20.0 * next(state), 7.0, 590.0}};
    struct iso_meet_points points;
    struct iso_meetings plain, many;
    memset(&plain, 0, sizeof plain);
    memset(&many, 0, sizeof many);
    make_points(frame, &pose, state, &points);
    iso__meet_many_plain(frame, &pose, &points, n, cutoff_mm, &plain);
    iso__meet_many_baseline(frame, &pose, &points, n, cutoff_mm, &many);
    check_equal(&plain, &many, n);
    iso_meet_many(frame, &pose, &points, n, cutoff_mm, &many);
    check_equal(&plain, &many, n);
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        memset(&many, 0, sizeof many);
        iso__meet_many_avx2(frame, &pose, &points, n, cutoff_mm, &many);
        check_equal(&plain, &many, n);
    }
#endif
    for (int i = 0; i < n; i++) {
        count[plain.meeting[i]]++;
    }
}

static void many_points_are_compared_like_one(void **state)
{
    (void)state;
    struct iso_frame *frame = new_frame();
    uint64_t random = 11;
    int count[ISO_MEETINGS] = {0};
    for (int round = 0; round < ROUNDS; round++) {
        check_round(frame, &random, 1 + round % ISO_MEET_MANY, count);
    }
    for (int meeting = 0; meeting < ISO_MEETINGS; meeting++) {
        assert_true(count[meeting] > ROUNDS / 2);
    }
    iso_frame_free(frame);
}

/* A point in the middle of a plane at 600 mm, before it by 6 mm: by hand. */
static void a_point_before_a_plane_is_so_far_before_it(void **state)
{
    (void)state;
    struct iso_frame *frame = new_frame();
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        frame->depth_mm[i] = 600.0f;
    }
    const struct iso_rigid pose = {iso_mat3_identity(), {0.0, 0.0, 594.0}};
    struct iso_meet_points points;
    struct iso_meetings many;
    for (int i = 0; i < ISO_MEET_GROUP; i++) {
        iso_meet_points_set(&points, i, iso_vec3(3.0 * i, 0.0, 0.0), iso_vec3(0.0, 0.0, -1.0));
    }
    iso_meet_many(frame, &pose, &points, 3, 12.0, &many);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(many.meeting[i], ISO_MEETING_MEASURED);
        assert_true(fabs(many.distance_mm[i] - 6.0) < 1e-9);
        assert_true(fabs(many.weight[i] - 0.5625) < 1e-9); /* (1 - (6 / 12)^2)^2 */
        assert_true(fabs(many.turn_mm[0][i] - 0.0) < 1e-12);
        assert_true(fabs(many.turn_mm[1][i] - 3.0 * i) < 1e-12);
        assert_true(fabs(many.normal[2][i] - -1.0) < 1e-12);
    }
    iso_frame_free(frame);
}

/* Cameras for which the points are compared one by one, and frames without a second row. */
static void other_cameras_are_compared_one_by_one(void **state)
{
    (void)state;
    struct iso_frame *frame = new_frame();
    const struct iso_camera camera = frame->camera;
    uint64_t random = 23;
    for (int kind = 0; kind < 3; kind++) {
        frame->camera = camera;
        frame->camera.k1 = kind == 0 ? 0.05 : 0.0;
        frame->camera.projection = kind == 1 ? ISO_ORTHOGRAPHIC : ISO_PINHOLE;
        frame->camera.pitch_mm = 8.0;
        frame->height_px = kind == 2 ? 1 : HEIGHT;
        const struct iso_rigid pose = {iso_mat3_rotation(iso_vec3(0.1, -0.2, 0.3)), {0, 0, 600}};
        struct iso_meet_points points;
        struct iso_meetings plain, many;
        make_points(frame, &pose, &random, &points);
        iso__meet_many_plain(frame, &pose, &points, ISO_MEET_MANY, 20.0, &plain);
        iso_meet_many(frame, &pose, &points, ISO_MEET_MANY, 20.0, &many);
        check_equal(&plain, &many, ISO_MEET_MANY);
    }
    iso_frame_free(frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_points_are_compared_like_one),
        cmocka_unit_test(a_point_before_a_plane_is_so_far_before_it),
        cmocka_unit_test(other_cameras_are_compared_one_by_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
