/* Candidates and pose search on rendered heads with known poses, and on objects that are not heads.
 */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/core/find/find_rig.h"
#include "tests/core/surfaces/rendered_head.h"

enum { SHRINK = 3 };

static void a_head_is_found_in_every_attitude_and_distance(void **state)
{
    struct find_rig *f = *state;
    const double yaws[] = {0.0, 20.0, -30.0}, pitches[] = {0.0, 15.0, -15.0};
    const struct iso_vec3 places[] = {{20, -30, 420}, {-60, 40, 700}, {90, 10, 1100}};
    for (int y = 0; y < 3; y++) {
        for (int p = 0; p < 3; p++) {
            for (int d = 0; d < 3; d++) {
                struct iso_rigid truth = rendered_head_pose(yaws[y], pitches[p], places[d]);
                struct iso_pose_fit fit;
                rendered_head_clear(f->frame);
                rendered_head_draw(f->frame, f->model, NULL, 1.0, &truth);
                rendered_head_wall(f->frame, 1900.0f);
                assert_int_equal(find_rig_find(f, SHRINK, &fit), 0);
                rendered_head_assert_pose(&fit.camera_from_face, &truth, 3.0, 3.0);
                assert_true(fit.in_image > 0.99);
            }
        }
    }
}

static void a_nose_tip_is_among_the_candidates(void **state)
{
    struct find_rig *f = *state;
    struct iso_vec3 nose = {-40, 25, 600};
    struct iso_rigid truth = rendered_head_pose(15.0, -10.0, nose);
    struct iso_pose_fit fit;
    rendered_head_draw(f->frame, f->model, NULL, 1.0, &truth);
    assert_int_equal(find_rig_find(f, SHRINK, &fit), 0);
    assert_int_equal(f->n_parts, 1);
    double closest_mm = INFINITY;
    for (int i = 0; i < f->n_candidates; i++) {
        const struct iso_nose_candidate *c = &f->candidates[i];
        closest_mm = fmin(closest_mm, iso_norm(iso_sub(c->point_mm, nose)));
        assert_true(c->height_mm >= 7.0 && c->height_mm <= 60.0);
        assert_int_equal(c->part, 0);
        assert_true(i == 0 || c->height_mm <= f->candidates[i - 1].height_mm + 0.5);
        for (int k = 0; k < i; k++) {
            double apart_mm = iso_norm(iso_sub(c->point_mm, f->candidates[k].point_mm));
            assert_true(apart_mm > 15.0);
        }
    }
    assert_true(closest_mm < 8.0);
}

/* Draws two heads, the nearer one at the left, and asserts that the nearer one is found. */
static void assert_nearer_is_chosen(struct find_rig *f, const struct iso_vec3 *near_shape,
                                    double near_size, double far_size, double within_mm)
{
    struct iso_rigid near = rendered_head_pose(10.0, 5.0, iso_vec3(-110, 0, 650));
    struct iso_rigid far = rendered_head_pose(0.0, 0.0, iso_vec3(110, -20, 800));
    struct iso_pose_fit fit;
    rendered_head_clear(f->frame);
    rendered_head_draw(f->frame, f->model, near_shape, near_size, &near);
    rendered_head_draw(f->frame, f->model, NULL, far_size, &far);
    assert_int_equal(find_rig_find(f, SHRINK, &fit), 0);
    assert_int_equal(f->n_parts, 2);
    rendered_head_assert_pose(&fit.camera_from_face, &near, within_mm, 5.0);
}

static void the_nearer_of_two_people_is_chosen(void **state)
{
    struct find_rig *f = *state;
    assert_nearer_is_chosen(f, NULL, 1.0, 1.0, 3.0);
}

static void a_bigger_person_behind_is_not_chosen(void **state)
{
    struct find_rig *f = *state;
    /* The apparent sizes are 0.9 / 650 for the nearer head and 1.3 / 800 for the farther one. */
    assert_nearer_is_chosen(f, NULL, 0.9, 1.3, 12.0);
}

static void a_better_fit_behind_is_not_chosen(void **state)
{
    struct find_rig *f = *state;
    struct iso_vec3 *shape = calloc(f->model->n_vertices, sizeof *shape);
    assert_non_null(shape);
    for (uint32_t i = 0; i < f->model->n_vertices; i++) {
        struct iso_vec3 p = f->model->mean_mm[i];
        /* Adds waves that no mode of the model contains. The farther head is the mean head itself.
         */
        shape[i] = iso_vec3(p.x, p.y, p.z + 2.0 * sin(0.25 * p.x) * cos(0.2 * p.y));
    }
    assert_nearer_is_chosen(f, shape, 1.0, 1.0, 5.0);
    free(shape);
}

static void an_empty_frame_holds_nobody(void **state)
{
    struct find_rig *f = *state;
    struct iso_pose_fit fit = {.cost_mm2 = -7.0};
    assert_int_equal(find_rig_find(f, SHRINK, &fit), -ENOENT);
    assert_int_equal(f->n_parts, 0);
    assert_int_equal(f->n_candidates, 0);
    assert_true(fit.cost_mm2 == -7.0);
}

static void a_wall_is_no_face(void **state)
{
    struct find_rig *f = *state;
    struct iso_pose_fit fit = {.cost_mm2 = -7.0};
    rendered_head_wall(f->frame, 700.0f);
    assert_int_equal(find_rig_find(f, SHRINK, &fit), -ENOENT);
    assert_int_equal(f->n_parts, 1);
    assert_int_equal(f->n_candidates, 0);
    assert_true(fit.cost_mm2 == -7.0);
}

static void a_person_out_of_range_is_not_seen(void **state)
{
    struct find_rig *f = *state;
    struct iso_rigid pose = rendered_head_pose(0.0, 0.0, iso_vec3(0, 0, 2100));
    struct iso_pose_fit fit;
    rendered_head_draw(f->frame, f->model, NULL, 1.0, &pose);
    assert_int_equal(find_rig_find(f, SHRINK, &fit), -ENOENT);
    assert_int_equal(f->n_parts, 0);
}

/* Draws a ball. The other pixels stay as they are. */
static void draw_ball(struct iso_frame *frame, struct iso_vec3 centre, double radius_mm)
{
    for (int row = 0; row < frame->height_px; row++) {
        for (int column = 0; column < frame->width_px; column++) {
            struct iso_vec3 sight = iso_camera_back_project(&frame->camera, column, row, 1.0);
            double a = iso_dot(sight, sight), b = iso_dot(sight, centre);
            double c = iso_dot(centre, centre) - radius_mm * radius_mm;
            if (b * b > a * c) {
                frame->depth_mm[row * frame->width_px + column] =
                    (float)((b - sqrt(b * b - a * c)) / a);
            }
        }
    }
}

static void a_ball_is_no_face(void **state)
{
    struct find_rig *f = *state;
    const double radii_mm[] = {50.0, 75.0, 110.0, 160.0};
    for (int i = 0; i < 4; i++) {
        struct iso_pose_fit fit;
        rendered_head_clear(f->frame);
        draw_ball(f->frame, iso_vec3(15, -20, 800), radii_mm[i]);
        rendered_head_wall(f->frame, 1900.0f);
        assert_int_equal(find_rig_find(f, SHRINK, &fit), -ENOENT);
    }
}

/* Returns a pseudo-random number in 0..1 from a linear congruential generator (Numerical Recipes).
 */
static double next_uniform(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / 16777216.0;
}

static void noise_is_no_face(void **state)
{
    struct find_rig *f = *state;
    const double spreads_mm[] = {20.0, 60.0, 1500.0};
    uint32_t seed = 1;
    for (int s = 0; s < 3; s++) {
        for (int i = 0; i < f->frame->width_px * f->frame->height_px; i++) {
            f->frame->depth_mm[i] = (float)(400.0 + spreads_mm[s] * next_uniform(&seed));
        }
        struct iso_pose_fit fit;
        assert_int_equal(find_rig_find(f, SHRINK, &fit), -ENOENT);
    }
}

/* The rows above the face have tens of thousands of pixels that are not connected with each other.
 */
static void scraps_do_not_hide_a_face(void **state)
{
    struct find_rig *f = *state;
    struct iso_rigid truth = rendered_head_pose(0.0, 0.0, iso_vec3(20, 110, 700));
    rendered_head_draw(f->frame, f->model, NULL, 1.0, &truth);
    for (int row = 0; row < 170; row++) {
        for (int column = 0; column < f->frame->width_px; column++) {
            f->frame->depth_mm[row * f->frame->width_px + column] = (row + column) % 2 ? 900.0f
                                                                                       : 1500.0f;
        }
    }
    assert_int_equal(iso_candidates_find(f->finder, f->frame, &find_rig_range, f->candidates,
                                         &f->n_candidates, &f->n_parts),
                     0);
    assert_int_equal(f->n_parts, 1);
    assert_true(f->n_candidates > 0);
}

/* The depths of an orthographic image have no fixed origin, so that 0 is in range; a depth of 0
 * still means that nothing was measured. */
static void unmeasured_pixels_are_no_part(void **state)
{
    struct find_rig *f = *state;
    const struct iso_candidate_options anywhere = {.near_mm = 0.0, .far_mm = INFINITY};
    f->frame->camera.projection = ISO_ORTHOGRAPHIC;
    f->frame->camera.pitch_mm = 1.0;
    struct iso_rigid truth = rendered_head_pose(0.0, 0.0, iso_vec3(20, 30, 300));
    rendered_head_draw(f->frame, f->model, NULL, 1.0, &truth);
    assert_int_equal(iso_candidates_find(f->finder, f->frame, &anywhere, f->candidates,
                                         &f->n_candidates, &f->n_parts),
                     0);
    assert_int_equal(f->n_parts, 1);
    assert_int_equal(f->candidates[0].part, 0);
}

static void a_frame_over_the_capacity_is_refused(void **state)
{
    struct find_rig *f = *state;
    struct iso_candidate_finder *small = NULL;
    int n_candidates = -7, n_parts = -7;
    assert_int_equal(iso_candidate_finder_new(640 * 480 - 1, &small), 0);
    assert_int_equal(iso_candidates_find(small, f->frame, &find_rig_range, f->candidates,
                                         &n_candidates, &n_parts),
                     -ENOSPC);
    assert_int_equal(n_candidates, -7);
    assert_int_equal(n_parts, -7);
    iso_candidate_finder_free(small);
    iso_candidate_finder_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_head_is_found_in_every_attitude_and_distance,
                                        find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(a_nose_tip_is_among_the_candidates, find_rig_new,
                                        find_rig_free),
        cmocka_unit_test_setup_teardown(the_nearer_of_two_people_is_chosen, find_rig_new,
                                        find_rig_free),
        cmocka_unit_test_setup_teardown(a_bigger_person_behind_is_not_chosen, find_rig_new,
                                        find_rig_free),
        cmocka_unit_test_setup_teardown(a_better_fit_behind_is_not_chosen, find_rig_new,
                                        find_rig_free),
        cmocka_unit_test_setup_teardown(an_empty_frame_holds_nobody, find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(a_wall_is_no_face, find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(a_person_out_of_range_is_not_seen, find_rig_new,
                                        find_rig_free),
        cmocka_unit_test_setup_teardown(a_ball_is_no_face, find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(noise_is_no_face, find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(scraps_do_not_hide_a_face, find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(unmeasured_pixels_are_no_part, find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(a_frame_over_the_capacity_is_refused, find_rig_new,
                                        find_rig_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
