/* Principal components and discriminant analysis, compared with the structure of the samples. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "sim/base/random.h"
#include "sim/lab/methods/subspace.h"

enum { N = 60, D = 7, PEOPLE = 12 };

/* Samples with a deviation of 5 along (1, 1, 0, ...) and of 2 along e2, and none along other axes.
 */
static void draw_plane(float samples[N][D])
{
    struct sim_random random = sim_random_seeded(1, 2, 3);
    for (int i = 0; i < N; i++) {
        double a = 5.0 * sim_random_normal(&random), b = 2.0 * sim_random_normal(&random);
        for (int k = 0; k < D; k++) {
            samples[i][k] = (float)(100.0 + k);
        }
        samples[i][0] += (float)(a / sqrt(2.0));
        samples[i][1] += (float)(a / sqrt(2.0));
        samples[i][2] += (float)b;
    }
}

static void test_principal_components_are_white(void **state)
{
    (void)state;
    float samples[N][D], c[D];
    struct sim_subspace *s = NULL;
    draw_plane(samples);
    assert_int_equal(sim_subspace_principal(&samples[0][0], N, D, 1.0, D, &s), 0);
    assert_int_equal(s->n_out, 2);
    double square[2] = {0.0}, product = 0.0;
    for (int i = 0; i < N; i++) {
        sim_subspace_project(s, samples[i], c);
        square[0] += (double)(c[0] * c[0]);
        square[1] += (double)(c[1] * c[1]);
        product += (double)(c[0] * c[1]);
    }
    assert_float_equal((square[0] / (N - 1)), 1.0, 1e-3);
    assert_float_equal((square[1] / (N - 1)), 1.0, 1e-3);
    assert_float_equal((product / (N - 1)), 0.0, 1e-3);
    /* The first component is the long one, in equal parts along its two axes. */
    assert_true(fabsf(s->basis[0] - s->basis[1]) < 0.01f * fabsf(s->basis[0]));
    assert_true(fabsf(s->basis[2]) < 0.2f * fabsf(s->basis[0]));
    sim_subspace_free(s);
    /* One component is enough for most of the variance. */
    assert_int_equal(sim_subspace_principal(&samples[0][0], N, D, 0.6, D, &s), 0);
    assert_int_equal(s->n_out, 1);
    sim_subspace_free(s);
}

/* People differ by 1 along e0. Samples of one person differ by 10 along e1. */
static void test_discriminant_finds_what_tells_people_apart(void **state)
{
    (void)state;
    float samples[N][D] = {{0.0f}}, a[D], b[D], c[D];
    uint32_t person[N];
    struct sim_random random = sim_random_seeded(1, 2, 4);
    for (uint32_t i = 0; i < N; i++) {
        person[i] = i % PEOPLE;
        samples[i][0] = (float)(person[i] + 0.05 * sim_random_normal(&random));
        samples[i][1] = (float)(10.0 * sim_random_normal(&random));
    }
    struct sim_subspace *s = NULL;
    assert_int_equal(sim_subspace_discriminant(&samples[0][0], person, N, D, PEOPLE, 1.0, 0.0, &s),
                     0);
    assert_true(s->n_out >= 1 && s->n_out <= 2);
    sim_subspace_project(s, samples[3], a);
    sim_subspace_project(s, samples[3 + PEOPLE], b);
    sim_subspace_project(s, samples[4], c);
    assert_true(fabsf(a[0] - c[0]) > 5.0f * fabsf(a[0] - b[0]));
    sim_subspace_free(s);
}

static void test_refusals(void **state)
{
    (void)state;
    float samples[N][D], same[N][D] = {{0.0f}};
    uint32_t one[N] = {0}, all[N];
    struct sim_subspace *s = NULL;
    draw_plane(samples);
    for (uint32_t i = 0; i < N; i++) {
        all[i] = i;
    }
    assert_int_equal(sim_subspace_principal(&samples[0][0], 1, D, 1.0, D, &s), -EINVAL);
    assert_int_equal(sim_subspace_principal(&same[0][0], N, D, 1.0, D, &s), -EINVAL);
    assert_int_equal(sim_subspace_discriminant(&samples[0][0], one, N, D, 1, 1.0, 0.1, &s),
                     -EINVAL);
    assert_int_equal(sim_subspace_discriminant(&samples[0][0], all, N, D, N, 1.0, 0.1, &s),
                     -EINVAL);
    assert_null(s);
}

static void test_cosine(void **state)
{
    (void)state;
    const float a[] = {3.0f, 0.0f}, b[] = {0.5f, 0.0f}, c[] = {0.0f, 2.0f}, d[] = {-1.0f, 0.0f},
                none[] = {0.0f, 0.0f};
    assert_float_equal(sim_cosine_distance(a, b, 2), 0.0, 1e-6);
    assert_float_equal(sim_cosine_distance(a, c, 2), 1.0, 1e-6);
    assert_float_equal(sim_cosine_distance(a, d, 2), 2.0, 1e-6);
    assert_float_equal(sim_cosine_distance(a, none, 2), 1.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_principal_components_are_white),
        cmocka_unit_test(test_discriminant_finds_what_tells_people_apart),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_cosine),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
