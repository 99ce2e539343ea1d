/* Synthetic people: populations, surfaces and expressions. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/world/face/expression.h"
#include "sim/world/face/person.h"
#include "sim/world/scene/sitter.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

static struct sim_ict *load_model(void)
{
    struct sim_ict *ict = NULL;
    struct iso_fault fault = {.text = ""};
    if (!scratch_exists(shared_data("data/ict-face"))) {
        skip();
    }
    int error = sim_ict_load(shared_data("data/ict-face"), &ict, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
    return ict;
}

static bool same_person(const struct sim_person *a, const struct sim_person *b)
{
    return memcmp(a->identity, b->identity, sizeof a->identity) == 0 && a->key == b->key;
}

static void people_repeat_and_populations_differ(void **state)
{
    (void)state;
    struct sim_person a = sim_person_draw(SIM_POPULATION_TEST, 1, 5, 1.0);
    struct sim_person same = sim_person_draw(SIM_POPULATION_TEST, 1, 5, 1.0);
    struct sim_person others[] = {sim_person_draw(SIM_POPULATION_TRAIN, 1, 5, 1.0),
                                  sim_person_draw(SIM_POPULATION_TEST, 2, 5, 1.0),
                                  sim_person_draw(SIM_POPULATION_TEST, 1, 6, 1.0)};
    assert_true(same_person(&a, &same));
    for (int i = 0; i < 3; i++) {
        assert_false(same_person(&a, &others[i]));
    }
}

static void identity_has_the_variance_asked_for(void **state)
{
    (void)state;
    static const double scales[] = {1.0, 0.36};
    enum { PEOPLE = 300 };
    for (int k = 0; k < 2; k++) {
        double squares = 0.0, n = PEOPLE * SIM_IDENTITY_MODES;
        for (uint32_t i = 0; i < PEOPLE; i++) {
            struct sim_person p = sim_person_draw("variance", 1, i, scales[k]);
            for (int m = 0; m < SIM_IDENTITY_MODES; m++) {
                squares += p.identity[m] * p.identity[m];
            }
        }
        assert_true(fabs(squares / n / scales[k] - 1.0) < 4.0 * sqrt(2.0 / n));
    }
}

/* The names of the model's shapes are enough to draw an expression. */
static char names[][32] = {"browDown_L",   "browDown_R",  "jawOpen",     "mouthSmile_L",
                           "mouthSmile_R", "mouthClose",  "eyeLookIn_L", "eyeBlink_L",
                           "eyeBlink_R",   "mouthPucker", "eyeLookIn_R"};
enum { NAMES = sizeof names / sizeof *names, SMILE_L = 3, SMILE_R = 4 };
static const struct sim_ict shapes = {.n_expression = NAMES, .expression_names = names};

static void weights_stay_in_range(void **state)
{
    (void)state;
    struct sim_random random = sim_random_seeded(3, 0, 0);
    for (int e = 0; e < SIM_EXPRESSIONS; e++) {
        for (int i = 0; i < 200; i++) {
            double weights[NAMES];
            enum sim_expression drawn = sim_expression_draw(&shapes, (enum sim_expression)e,
                                                            &random, weights);
            assert_true(e == SIM_STRONG ? drawn > SIM_STRONG : (int)drawn == e);
            for (int k = 0; k < NAMES; k++) {
                assert_true(weights[k] >= 0.0 && weights[k] <= 1.0);
                bool fixed = strncmp(names[k], "eyeLook", 7) == 0 || k == 5;
                assert_true(!fixed || weights[k] <= 0.0);
                assert_true(e > SIM_MILD || weights[k] < 0.6);
                assert_true(e != SIM_NEUTRAL || weights[k] < 0.3);
            }
        }
    }
}

static void a_smile_is_wide_and_nearly_symmetric(void **state)
{
    (void)state;
    struct sim_random random = sim_random_seeded(4, 0, 0);
    double sides = 0.0, difference = 0.0;
    enum { N = 300 };
    for (int i = 0; i < N; i++) {
        double w[NAMES];
        (void)sim_expression_draw(&shapes, SIM_SMILE, &random, w);
        assert_true(w[SMILE_L] > 0.35 && w[SMILE_R] > 0.35);
        sides += (w[SMILE_L] + w[SMILE_R]) / (2 * N);
        difference += fabs(w[SMILE_L] - w[SMILE_R]) / N;
    }
    assert_true(sides > 0.75 && sides < 0.95);
    assert_true(difference > 0.02 && difference < 0.15);
}

static void strong_ones_are_all_drawn(void **state)
{
    (void)state;
    struct sim_random random = sim_random_seeded(5, 0, 0);
    int count[SIM_EXPRESSIONS] = {0};
    for (int i = 0; i < 1000; i++) {
        double weights[NAMES];
        count[sim_expression_draw(&shapes, SIM_STRONG, &random, weights)]++;
    }
    for (int e = SIM_SMILE; e < SIM_EXPRESSIONS; e++) {
        assert_true(count[e] > 50);
        assert_non_null(sim_expression_name((enum sim_expression)e));
    }
    assert_null(sim_expression_name(SIM_EXPRESSIONS));
}

/* Yaw to the subject's left turns towards the image's right. Pitch up turns up. Roll moves the
 * subject's right ear down. */
static void poses_turn_the_right_way(void **state)
{
    (void)state;
    struct sim_stance stance = {.nose_mm = {10.0, 20.0, 600.0}};
    struct iso_vec3 ahead = {0, 0, 1}, up = {0, 1, 0};
    struct iso_rigid pose = sim_stance_camera_from_face(&stance);
    struct iso_vec3 frontal = iso_mat3_apply(&pose.rotation, ahead);
    assert_true(fabs(frontal.z + 1.0) < 1e-12 && fabs(pose.translation_mm.y - 20.0) < 1e-12);
    stance.yaw_rad = 0.3;
    pose = sim_stance_camera_from_face(&stance);
    struct iso_vec3 left = iso_mat3_apply(&pose.rotation, ahead);
    assert_true(fabs(left.x - sin(0.3)) < 1e-12 && fabs(left.y) < 1e-12);
    stance = (struct sim_stance){.pitch_rad = 0.2};
    pose = sim_stance_camera_from_face(&stance);
    struct iso_vec3 raised = iso_mat3_apply(&pose.rotation, ahead);
    assert_true(fabs(raised.y + sin(0.2)) < 1e-12 && fabs(raised.x) < 1e-12);
    stance = (struct sim_stance){.roll_rad = 0.1};
    pose = sim_stance_camera_from_face(&stance);
    struct iso_vec3 tilted = iso_mat3_apply(&pose.rotation, up);
    assert_true(fabs(tilted.x + sin(0.1)) <
                1e-12); /* the crown moves to the image's left: the subject's right */
}

static void surfaces_are_sums_of_modes(void **state)
{
    (void)state;
    struct sim_ict *ict = load_model();
    struct sim_person person = sim_person_mean();
    struct iso_vec3 *surface = calloc(ict->n_vertices, sizeof *surface);
    double weights[SIM_EXPRESSION_SHAPES_MAX] = {0};
    uint32_t tip = ict->landmarks[30], v = ict->landmarks[54];
    size_t n = (size_t)ict->n_vertices * 3;
    sim_person_surface(ict, &person, NULL, surface);
    assert_true(iso_norm(surface[tip]) < 1e-4);
    assert_true(surface[v].x > 15.0 && surface[v].y < -15.0); /* the subject's left mouth corner */
    struct iso_vec3 before = surface[v];
    person.identity[3] = 2.0;
    weights[7] = 0.5;
    sim_person_surface(ict, &person, weights, surface);
    struct iso_vec3 moved = iso_sub(surface[v], before);
    const float *identity = ict->identity_mm + 3 * n + 3 * v;
    const float *expression = ict->expression_mm + 7 * n + 3 * v;
    assert_true(fabs(moved.x - (2.0 * (double)identity[0] + 0.5 * (double)expression[0])) < 1e-4);
    assert_true(fabs(moved.y - (2.0 * (double)identity[1] + 0.5 * (double)expression[1])) < 1e-4);
    assert_true(fabs(moved.z - (2.0 * (double)identity[2] + 0.5 * (double)expression[2])) < 1e-4);
    free(surface);
    sim_ict_free(ict);
}

static void a_missing_model_is_named(void **state)
{
    struct sim_ict *ict = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_ict_load(scratch_path(*state, "nothing"), &ict, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "nothing/mean.npy"));
    assert_null(ict);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(people_repeat_and_populations_differ),
        cmocka_unit_test(identity_has_the_variance_asked_for),
        cmocka_unit_test(weights_stay_in_range),
        cmocka_unit_test(a_smile_is_wide_and_nearly_symmetric),
        cmocka_unit_test(strong_ones_are_all_drawn),
        cmocka_unit_test(poses_turn_the_right_way),
        cmocka_unit_test(surfaces_are_sums_of_modes),
        cmocka_unit_test(a_missing_model_is_named),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
