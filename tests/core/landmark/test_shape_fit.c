/* The head model is fitted to rendered heads with known pose, identity and expression. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/landmark/shape_fitter.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"

static const struct iso_shape_fit_options usual = {
    .rigid_iterations = 4,
    .iterations = 8,
    .jaws = 1,
    .cutoff_first_mm = 12.0,
    .cutoff_last_mm = 4.0,
    .soft_weight = 0.3,
    .identity_stiffness_mm2 = 20.0,
    .expression_stiffness_mm2 = 5.0,
};

/* A weak prior, so that the fitted coefficients are hardly smaller than the rendered ones. (Without
 * a prior, modes compensate each other and the pose.) */
static const struct iso_shape_fit_options trusting = {
    .rigid_iterations = 4,
    .iterations = 24,
    .jaws = 3,
    .cutoff_first_mm = 12.0,
    .cutoff_last_mm = 4.0,
    .soft_weight = 1.0,
    .identity_stiffness_mm2 = 2.5,
    .expression_stiffness_mm2 = 2.5,
};

struct fixture {
    struct iso_head_model *model;
    struct iso_frame *frame;
    struct iso_shape_fitter *fitter;
    struct iso_vec3 *shape;   /* as rendered */
    struct iso_vec3 *neutral; /* the same person without the expression */
    struct iso_rigid truth, start;
};

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->model = shipped_head_model();
    f->frame = rendered_head_frame();
    f->shape = calloc(f->model->n_vertices, sizeof *f->shape);
    f->neutral = calloc(f->model->n_vertices, sizeof *f->neutral);
    assert_true(f->shape && f->neutral);
    memcpy(f->shape, f->model->mean_mm, f->model->n_vertices * sizeof *f->shape);
    f->truth = rendered_head_pose(12.0, -6.0, iso_vec3(25, -15, 520));
    f->start = rendered_head_pose(7.0, -2.0, iso_vec3(29, -20, 525));
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    iso_shape_fitter_free(f->fitter);
    iso_frame_free(f->frame);
    iso_head_model_free(f->model);
    free(f->shape);
    free(f->neutral);
    free(f);
    return 0;
}

static void add_mode(struct fixture *f, const float *modes_mm, uint32_t mode, double coefficient)
{
    for (uint32_t i = 0; i < f->model->n_vertices; i++) {
        const float *m = &modes_mm[3 * ((size_t)mode * f->model->n_vertices + i)];
        struct iso_vec3 by = {(double)m[0], (double)m[1], (double)m[2]};
        f->shape[i] = iso_madd(f->shape[i], coefficient, by);
    }
}

static const double identity[] = {1.2, -0.8, 0.0, 0.7, -1.1};
static const double expression[] = {0.0, 0.9, -0.6};

enum {
    IDENTITY = sizeof identity / sizeof identity[0],
    EXPRESSION = sizeof expression / sizeof expression[0]
};

/* Makes and draws a person who is not the mean, with an expression. */
static void draw_person(struct fixture *f)
{
    for (uint32_t k = 0; k < IDENTITY; k++) {
        add_mode(f, f->model->identity_mm, k, identity[k]);
    }
    memcpy(f->neutral, f->shape, f->model->n_vertices * sizeof *f->shape);
    for (uint32_t k = 0; k < EXPRESSION; k++) {
        add_mode(f, f->model->expression_mm, k, expression[k]);
    }
    rendered_head_draw(f->frame, f->model, f->shape, 1.0, &f->truth);
}

static void the_mean_head_comes_back_as_itself(void **state)
{
    struct fixture *f = *state;
    struct iso_shape_fit fit;
    rendered_head_draw(f->frame, f->model, NULL, 1.0, &f->truth);
    assert_int_equal(iso_shape_fitter_new(f->model, &usual, &f->fitter), 0);
    assert_int_equal(iso_shape_fit(f->fitter, f->frame, &f->start, &fit), 0);
    rendered_head_assert_pose(&fit.pose.camera_from_face, &f->truth, 0.4, 0.3);
    /* The vertices of the cheek that the nose hides count with the largest residual. */
    assert_true(fit.pose.cost_mm2 < 3.5);
    assert_true(fit.pose.coverage > 0.99);
    assert_true(fit.pose.in_image == 1.0);
    for (uint32_t k = 0; k < ISO_HEAD_IDENTITY_MAX; k++) {
        assert_true(fabsf(fit.identity[k]) < 0.1f);
    }
    for (uint32_t k = 0; k < ISO_HEAD_EXPRESSION_MAX; k++) {
        assert_true(fabsf(fit.expression[k]) < 0.25f);
    }
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_vec3 at = iso_head_point_on(f->model, f->model->mean_mm,
                                               f->model->landmarks[iso_landmark_ibug[l]]);
        assert_true(iso_norm(iso_sub(fit.neutral_mm[l], at)) < 0.5);
    }
}

static void known_coefficients_are_recovered(void **state)
{
    struct fixture *f = *state;
    struct iso_shape_fit fit;
    draw_person(f);
    assert_int_equal(iso_shape_fitter_new(f->model, &trusting, &f->fitter), 0);
    assert_int_equal(iso_shape_fit(f->fitter, f->frame, &f->start, &fit), 0);
    rendered_head_assert_pose(&fit.pose.camera_from_face, &f->truth, 1.0, 0.5);
    for (uint32_t k = 0; k < f->model->n_identity; k++) {
        double truth = k < IDENTITY ? identity[k] : 0.0;
        assert_true(fabs((double)fit.identity[k] - truth) < (k < IDENTITY ? 0.35 : 0.8));
    }
    for (uint32_t k = 0; k < f->model->n_expression; k++) {
        double truth = k < EXPRESSION ? expression[k] : 0.0;
        assert_true(fabs((double)fit.expression[k] - truth) < (k < EXPRESSION ? 0.45 : 0.8));
    }
}

static void landmarks_are_those_of_the_neutral_head(void **state)
{
    struct fixture *f = *state;
    struct iso_shape_fit fit;
    double squares = 0.0;
    draw_person(f);
    assert_int_equal(iso_shape_fitter_new(f->model, &usual, &f->fitter), 0);
    assert_int_equal(iso_shape_fit(f->fitter, f->frame, &f->start, &fit), 0);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_vec3 truth = iso_head_point_on(f->model, f->neutral,
                                                  f->model->landmarks[iso_landmark_ibug[l]]);
        struct iso_vec3 found = iso_rigid_apply(&fit.pose.camera_from_face, fit.neutral_mm[l]);
        struct iso_vec3 off = iso_sub(found, iso_rigid_apply(&f->truth, truth));
        squares += iso_dot(off, off);
        assert_true(iso_norm(off) < 2.0);
    }
    assert_true(sqrt(squares / ISO_LANDMARKS) < 1.0);
}

/* One fitter fits one face after another. Nothing of a face remains in the next fit. */
static void a_fit_does_not_depend_on_the_one_before(void **state)
{
    struct fixture *f = *state;
    struct iso_shape_fit first, second;
    struct iso_frame *mean = rendered_head_frame();
    draw_person(f);
    rendered_head_draw(mean, f->model, NULL, 1.0, &f->truth);
    assert_int_equal(iso_shape_fitter_new(f->model, &usual, &f->fitter), 0);
    assert_int_equal(iso_shape_fit(f->fitter, mean, &f->start, &first), 0);
    assert_int_equal(iso_shape_fit(f->fitter, f->frame, &f->start, &second), 0);
    assert_true(fabsf(second.identity[0] - first.identity[0]) > 0.2f);
    assert_int_equal(iso_shape_fit(f->fitter, mean, &f->start, &second), 0);
    assert_memory_equal(&first, &second, sizeof first);
    iso_frame_free(mean);
}

static void the_pose_alone_is_that_of_the_fit(void **state)
{
    struct fixture *f = *state;
    struct iso_shape_fit fit;
    struct iso_pose_fit pose;
    draw_person(f);
    assert_int_equal(iso_shape_fitter_new(f->model, &usual, &f->fitter), 0);
    assert_int_equal(iso_shape_fit(f->fitter, f->frame, &f->start, &fit), 0);
    assert_int_equal(iso_shape_fit_pose(f->fitter, f->frame, &f->start, &pose), 0);
    assert_memory_equal(&fit.pose, &pose, sizeof pose);
    memset(f->frame->depth_mm, 0,
           (size_t)f->frame->width_px * (size_t)f->frame->height_px * sizeof *f->frame->depth_mm);
    assert_int_equal(iso_shape_fit_pose(f->fitter, f->frame, &f->start, &pose), -ENODATA);
    assert_memory_equal(&fit.pose, &pose, sizeof pose);
}

/* How many starts of a fit of the person are given up with this number of iterations. */
static int given_up(struct fixture *f, int iterations)
{
    struct iso_shape_fit fit;
    struct iso_shape_fit_options options = usual;
    options.iterations = iterations;
    options.jaws = ISO_SHAPE_FIT_JAWS_MAX;
    assert_int_equal(iso_shape_fitter_new(f->model, &options, &f->fitter), 0);
    assert_int_equal(iso_shape_fit(f->fitter, f->frame, &f->start, &fit), 0);
    const int n = f->fitter->given_up;
    iso_shape_fitter_free(f->fitter);
    f->fitter = NULL;
    return n;
}

/* The bounds by which a start is given up hold for nine and ten iterations alone. */
static void starts_are_given_up_only_where_the_bounds_hold(void **state)
{
    static const int others[] = {1, 4, 6, 7, 8, 11, 12, 24};
    struct fixture *f = *state;
    draw_person(f);
    assert_true(given_up(f, 9) > 0);
    assert_true(given_up(f, 10) > 0);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        assert_int_equal(given_up(f, others[i]), 0);
    }
}

static void too_little_of_a_face_is_no_data(void **state)
{
    struct fixture *f = *state;
    struct iso_shape_fit fit, untouched;
    memset(&fit, 0x5a, sizeof fit);
    memset(&untouched, 0x5a, sizeof untouched);
    assert_int_equal(iso_shape_fitter_new(f->model, &usual, &f->fitter), 0);
    assert_int_equal(iso_shape_fit(f->fitter, f->frame, &f->start, &fit), -ENODATA);
    assert_memory_equal(&fit, &untouched, sizeof fit);
    /* There are enough measurements, but the wall is beyond the cut-off, so that none of them
     * counts. */
    f->start = rendered_head_pose(0.0, 0.0, iso_vec3(0, 0, 520));
    rendered_head_wall(f->frame, 3000.0f);
    assert_int_equal(iso_shape_fit(f->fitter, f->frame, &f->start, &fit), -ENODATA);
    assert_memory_equal(&fit, &untouched, sizeof fit);
}

static void bad_fitters_are_refused(void **state)
{
    struct fixture *f = *state;
    struct iso_shape_fit_options bad[11];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        bad[i] = usual;
    }
    bad[0].rigid_iterations = 0;
    bad[1].rigid_iterations = 65;
    bad[2].iterations = 0;
    bad[3].iterations = 65;
    bad[4].cutoff_last_mm = 0.0;
    bad[5].cutoff_first_mm = 3.9; /* below the last */
    bad[6].soft_weight = -0.1;
    bad[7].soft_weight = 1.1;
    bad[8].identity_stiffness_mm2 = 0.0;
    bad[9].expression_stiffness_mm2 = NAN;
    bad[10].cutoff_first_mm = INFINITY;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(iso_shape_fitter_new(f->model, &bad[i], &f->fitter), -EINVAL);
        assert_null(f->fitter);
    }
    memset(f->model->region, ISO_HEAD_RIGID, f->model->n_vertices); /* no face */
    assert_int_equal(iso_shape_fitter_new(f->model, &usual, &f->fitter), -EINVAL);
    assert_null(f->fitter);
    iso_shape_fitter_free(NULL);
}

static void the_rigid_fit_finds_the_mean_head(void **state)
{
    struct fixture *f = *state;
    const struct iso_pose_options options = {
        .iterations = 12, .cutoff_first_mm = 20.0, .cutoff_last_mm = 4.0};
    struct iso_pose_vertices *vertices = NULL;
    struct iso_pose_fit fit;
    rendered_head_draw(f->frame, f->model, NULL, 1.0, &f->truth);
    assert_int_equal(iso_pose_vertices_new(f->model, 220, 0.5, &vertices), 0);
    assert_int_equal(vertices->n, 220);
    assert_int_equal(iso_pose_fit(vertices, f->frame, &options, &f->start, &fit), 0);
    rendered_head_assert_pose(&fit.camera_from_face, &f->truth, 0.5, 0.3);
    assert_true(fit.cost_mm2 < 3.5 && fit.coverage > 0.99 && fit.in_image == 1.0);
    iso_pose_vertices_free(vertices);
}

/* The left border of this window of the image is the middle of the face. */
static void a_cut_head_is_partly_out_of_the_image(void **state)
{
    struct fixture *f = *state;
    const struct iso_pose_options options = {
        .iterations = 8, .cutoff_first_mm = 10.0, .cutoff_last_mm = 4.0};
    struct iso_pose_vertices *vertices = NULL;
    struct iso_pose_fit fit;
    struct iso_camera camera = rendered_head_camera();
    struct iso_frame *window = NULL;
    assert_int_equal(iso_frame_new(&camera, 330, 480, false, &window), 0);
    window->crop_x_px = 310;
    struct iso_rigid truth = rendered_head_pose(0.0, 0.0, iso_vec3(0, 0, 520));
    rendered_head_draw(window, f->model, NULL, 1.0, &truth);
    assert_int_equal(iso_pose_vertices_new(f->model, 0, 1.0, &vertices), 0);
    assert_int_equal(iso_pose_fit(vertices, window, &options, &truth, &fit), 0);
    rendered_head_assert_pose(&fit.camera_from_face, &truth, 2.0, 1.5);
    assert_true(fabs(fit.in_image - 0.5) < 0.05);
    assert_true(fit.coverage <= fit.in_image + 1e-9 && fit.coverage > 0.45);
    iso_pose_vertices_free(vertices);
    iso_frame_free(window);
}

static struct iso_vec3 point_of(const struct iso_pose_vertices *vertices, int i)
{
    const struct iso_meet_points *some = &vertices->points[i / ISO_MEET_MANY];
    const int k = i % ISO_MEET_MANY;
    return iso_vec3(some->point_mm[0][k], some->point_mm[1][k], some->point_mm[2][k]);
}

static struct iso_vec3 normal_of(const struct iso_pose_vertices *vertices, int i)
{
    const struct iso_meet_points *some = &vertices->points[i / ISO_MEET_MANY];
    const int k = i % ISO_MEET_MANY;
    return iso_vec3(some->normal[0][k], some->normal[1][k], some->normal[2][k]);
}

static void chosen_vertices_are_spread_and_weighted(void **state)
{
    struct fixture *f = *state;
    struct iso_pose_vertices *few = NULL, *all = NULL;
    int face = 0;
    for (uint32_t i = 0; i < f->model->n_vertices; i++) {
        face += (f->model->region[i] & ISO_HEAD_FACE) != 0;
    }
    assert_int_equal(iso_pose_vertices_new(f->model, 40, 0.25, &few), 0);
    assert_int_equal(iso_pose_vertices_new(f->model, 0, 0.25, &all), 0);
    assert_int_equal(few->n, 40);
    assert_int_equal(all->n, face);
    int rigid = 0, soft = 0;
    for (int i = 0; i < few->n; i++) {
        assert_true(fabs(iso_norm(normal_of(few, i)) - 1.0) < 1e-9);
        rigid += few->weight[i] == 1.0;
        soft += few->weight[i] == 0.25;
        for (int k = 0; k < i; k++) { /* 40 places on some 30,000 mm^2 */
            assert_true(iso_norm(iso_sub(point_of(few, i), point_of(few, k))) > 10.0);
        }
    }
    assert_true(rigid > 0 && soft > 0);
    assert_int_equal(rigid + soft, few->n);
    iso_pose_vertices_free(few);
    iso_pose_vertices_free(all);
    few = NULL;
    assert_int_equal(iso_pose_vertices_new(f->model, -1, 0.25, &few), -EINVAL);
    assert_int_equal(iso_pose_vertices_new(f->model, 40, -0.1, &few), -EINVAL);
    memset(f->model->region, 0, f->model->n_vertices);
    assert_int_equal(iso_pose_vertices_new(f->model, 40, 0.25, &few), -EINVAL);
    assert_null(few);
    iso_pose_vertices_free(NULL);
}

static void a_rigid_fit_to_nothing_is_no_data(void **state)
{
    struct fixture *f = *state;
    const struct iso_pose_options options = {
        .iterations = 5, .cutoff_first_mm = 20.0, .cutoff_last_mm = 4.0};
    struct iso_pose_vertices *vertices = NULL;
    struct iso_pose_fit fit = {.cost_mm2 = -7.0};
    assert_int_equal(iso_pose_vertices_new(f->model, 220, 0.5, &vertices), 0);
    assert_int_equal(iso_pose_fit(vertices, f->frame, &options, &f->start, &fit), -ENODATA);
    rendered_head_wall(f->frame, 3000.0f); /* measured, but beyond the cut-off */
    assert_int_equal(iso_pose_fit(vertices, f->frame, &options, &f->start, &fit), -ENODATA);
    assert_true(fit.cost_mm2 == -7.0);
    iso_pose_vertices_free(vertices);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_mean_head_comes_back_as_itself, set_up, tear_down),
        cmocka_unit_test_setup_teardown(known_coefficients_are_recovered, set_up, tear_down),
        cmocka_unit_test_setup_teardown(landmarks_are_those_of_the_neutral_head, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_fit_does_not_depend_on_the_one_before, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_pose_alone_is_that_of_the_fit, set_up, tear_down),
        cmocka_unit_test_setup_teardown(starts_are_given_up_only_where_the_bounds_hold, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(too_little_of_a_face_is_no_data, set_up, tear_down),
        cmocka_unit_test_setup_teardown(bad_fitters_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_rigid_fit_finds_the_mean_head, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_cut_head_is_partly_out_of_the_image, set_up, tear_down),
        cmocka_unit_test_setup_teardown(chosen_vertices_are_spread_and_weighted, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_rigid_fit_to_nothing_is_no_data, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
