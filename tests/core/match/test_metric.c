/* The metric: registration, projection and score, on numbers small enough to calculate by hand. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/match/metric_vector.h"
#include "core/match/search.h"
#include "tests/core/match/small_metric.h"

/* The working memory of the functions under test. */
static struct iso_rerank_workspace work;

static void residuals_do_not_depend_on_the_pose(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric();
    struct iso_template t = small_template(m, 0.3);
    float residual_mm[ISO_METRIC_VALUES_MAX];
    assert_int_equal(iso_metric_residuals(m, &t, residual_mm), 0);
    for (int v = 0; v < m->n_values; v++) {
        assert_true(fabsf(residual_mm[v]) < 1e-4f);
    }
    /* A missing point contributes nothing, whatever value it has, and moves no other point. */
    t.points_mm[1][4][2][2] += 50.0f;
    t.weight[1][4][2] = 0.0f;
    assert_int_equal(iso_metric_residuals(m, &t, residual_mm), 0);
    for (int v = 0; v < m->n_values; v++) {
        assert_true(fabsf(residual_mm[v]) < 1e-4f);
    }
    t.weight[1][4][2] = 1.0f;
    assert_int_equal(iso_metric_residuals(m, &t, residual_mm), 0);
    assert_true(residual_mm[3 * (3 * POINTS + 2) + 2] > 30.0f);
    iso_metric_free(m);
}

static void it_refuses_what_it_cannot_compare(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric();
    struct iso_metric_vector out = {.n = 9};
    struct iso_template t = small_template(m, 0.0);
    t.algorithm = 78;
    assert_int_equal(iso_metric_project(m, &t, &out), -EINVAL);
    t = small_template(m, 0.0);
    t.n_points = POINTS - 1;
    assert_int_equal(iso_metric_project(m, &t, &out), -EINVAL);
    t = small_template(m, 0.0);
    memset(t.weight[0], 0, sizeof t.weight[0]);
    memset(t.weight[1][4], 0, sizeof t.weight[1][4]); /* a quarter is left */
    assert_int_equal(iso_metric_project(m, &t, &out), -ENODATA);
    assert_int_equal(out.n, 9);
    iso_metric_free(m);
}

/* Returns the squared length of a vector, with each number in its expected standard deviations. */
static double length_of(const struct iso_metric *m, const struct iso_metric_vector *v)
{
    double length = 0.0;
    for (int d = 0; d < DIMENSIONS; d++) {
        const double x = (double)(v->scale * v->mean[d]);
        length += x * x / (iso_metric_variance(v->step) + (double)m->between[d]);
    }
    return length;
}

static void a_vector_has_the_length_that_is_expected(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric();
    struct iso_template t = small_template(m, 0.2);
    struct iso_metric_vector once, twice;
    t.points_mm[0][1][3][0] += 2.0f;
    assert_int_equal(iso_metric_project(m, &t, &once), 0);
    assert_true(fabs(length_of(m, &once) - DIMENSIONS) < 1e-4);
    twice = once;
    twice.mean[1] += 1.0f;
    iso_metric_vector_add(m, &once, &twice);
    assert_int_equal(twice.n, 2);
    assert_int_equal(twice.step, once.step + 2);
    assert_true(fabs(length_of(m, &twice) - DIMENSIONS) < 1e-4);
    assert_true(fabsf(twice.mean[1] - once.mean[1] - 0.5f) < 1e-5f);
    assert_true(fabsf(twice.mean[2] - once.mean[2]) < 1e-5f);
    iso_metric_free(m);
}

static void missing_heights_do_not_count(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric();
    struct iso_template t = small_template(m, 0.0);
    float residual_mm[ISO_METRIC_VALUES_MAX];
    t.upper.z_mm[0][3] += 2.0f; /* filled in */
    t.upper.z_mm[2][1] -= 3.0f;
    t.upper.z_mm[ISO_UPPER_ROWS - 1][ISO_UPPER_COLUMNS - 1] = 0.0f;
    t.upper.kind[ISO_UPPER_ROWS - 1][ISO_UPPER_COLUMNS - 1] = ISO_UPPER_NONE;
    assert_int_equal(iso_metric_residuals(m, &t, residual_mm), 0);
    const float *height_mm = &residual_mm[m->n_curve_values];
    assert_true(fabsf(height_mm[0] - 2.0f) < 1e-5f && fabsf(height_mm[1] + 3.0f) < 1e-5f);
    assert_true(fabsf(height_mm[2]) < 1e-9f);
    iso_metric_free(m);
}

/* The numbers are quantiles of normal distributions with a known variance. The projection finds the
 * step of this variance. */
static void a_vector_has_the_step_of_its_noise(void **state)
{
    (void)state;
    enum { MANY = 150 };
    const struct iso_metric shape = {.algorithm = 77,
                                     .landmarks = 1,
                                     .n_radii = 1,
                                     .n_points = 4,
                                     .n_dimensions = MANY,
                                     .weight_min = 0.25f,
                                     .gain = 1.0f};
    struct iso_metric *m = NULL;
    assert_int_equal(iso_metric_new(&shape, &m), 0);
    struct iso_template t = {.algorithm = 77, .n_radii = 1, .n_points = 4, .n_frames = 1};
    for (int i = 0; i < 4; i++) { /* it equals the mean curve, so that its residuals are 0 */
        t.weight[0][0][i] = 1.0f;
        for (int k = 0; k < 3; k++) {
            m->curve_mm[3 * i + k] = t.points_mm[0][0][i][k] = (float)((i * i + k * 3 * i) % 7);
        }
    }
    for (int step = -6; step <= 6; step += 3) {
        for (int d = 0; d < MANY; d++) {
            /* Normal quantiles, in an order that does not depend on the variances. */
            const double u = (d * 67 % MANY + 0.5) / MANY, q = log(u / (1.0 - u)) / 1.702;
            m->between[d] = 50.0f * expf(-0.1f * (float)d);
            m->centre[d] = -(float)(q * sqrt(iso_metric_variance(step) + (double)m->between[d]));
        }
        struct iso_metric_vector v;
        assert_int_equal(iso_metric_project(m, &t, &v), 0);
        assert_true(abs(v.step - step) <= 1);
        assert_true(fabs((double)v.weight * iso_metric_variance(v.step) - 1.0) < 1e-6);
    }
    iso_metric_free(m);
}

static void a_noisy_vector_counts_for_less(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric();
    const struct iso_metric_vector good = {1, 3.0f, 3, 1.0f, {1.0f, 2.0f, 3.0f}},
                                   poor = {2, 1.0f, 0, 1.0f, {5.0f, 2.0f, -1.0f}}, none = {.n = 0};
    struct iso_metric_vector all = none;
    iso_metric_vector_add(m, &none, &all);
    assert_int_equal(all.n, 0);
    iso_metric_vector_add(m, &good, &all);
    iso_metric_vector_add(m, &none, &all);
    assert_int_equal(all.n, 1);
    iso_metric_vector_add(m, &poor, &all);
    assert_int_equal(all.n, 3);
    assert_int_equal(all.step, 4); /* weight 4 */
    assert_true(fabsf(all.mean[0] - 2.0f) < 1e-6f && fabsf(all.mean[1] - 2.0f) < 1e-6f &&
                fabsf(all.mean[2] - 2.0f) < 1e-6f);
    iso_metric_free(m);
}

/* The log density of n numbers that vary by v about a common mean with variance b. The covariance
 * is diag(v) + b 11'. Let V = 1 / sum 1 / v, and let m be the mean weighted by 1 / v. The
 * differences of the numbers from m are independent of m, and the determinant is prod v (1 + b /
 * V). */
static double log_density(const double *x, const double *v, int n, double b)
{
    double weight = 0.0, sum = 0.0, square = 0.0, log_det = 0.0;
    for (int i = 0; i < n; i++) {
        weight += 1.0 / v[i];
        sum += x[i] / v[i];
        square += x[i] * x[i] / v[i];
        log_det += log(v[i]);
    }
    return -0.5 * (n * log(2.0 * M_PI) + log_det + log(1.0 + weight * b) + square -
                   b / (1.0 + weight * b) * sum * sum);
}

static void a_score_is_the_likelihood_ratio_of_one_person_and_two(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric();
    /* The weights are 1, 1 and 2: together 4. */
    const struct iso_metric_vector a = {1, 1.0f, 0, 1.0f, {2.0f, -1.0f, 0.5f}},
                                   b = {1, 1.0f, 0, 1.0f, {3.0f, 0.0f, -0.5f}},
                                   c = {1, 2.0f, 2, 1.0f, {2.5f, -0.7f, 0.1f}};
    const struct iso_metric_vector probe = {1, 0.5f, -2, 1.0f, {2.2f, 1.0f, 0.7f}};
    struct iso_metric_vector all = a;
    iso_metric_vector_add(m, &b, &all);
    iso_metric_vector_add(m, &c, &all);
    all.scale = 1.0f; /* the model itself */
    double ratio = 0.0;
    for (int d = 0; d < DIMENSIONS; d++) {
        const double x[4] = {(double)a.mean[d], (double)b.mean[d], (double)c.mean[d],
                             (double)probe.mean[d]};
        const double v[4] = {1.0, 1.0, 0.5, 2.0}, between = (double)m->between[d];
        ratio += log_density(x, v, 4, between) - log_density(x, v, 3, between) -
                 log_density(&x[3], &v[3], 1, between);
    }
    assert_true(fabs(iso_metric_score(m, &all, &probe) - (0.5 * ratio - 1.0)) < 1e-5);
    assert_true(fabs(iso_metric_score(m, &a, &c) - iso_metric_score(m, &c, &a)) < 1e-6);
    const struct iso_metric_vector nobody = {.n = 0};
    assert_true(iso_metric_score(m, &nobody, &probe) == -INFINITY);
    iso_metric_free(m);
}

/* Person 5 has two templates, person 6 has one whose points all have the weight 0, and person 7 has
 * one. */
static void a_search_takes_all_templates_of_a_person_together(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric();
    struct iso_template t[4];
    struct iso_metric_vector v[4], both;
    for (int i = 0; i < 4; i++) {
        t[i] = small_template(m, 0.1 * i);
        for (int k = 0; k < POINTS; k++) {
            t[i].points_mm[0][1][k][2] += (float)((i + 1) * (k % 3));
        }
        assert_int_equal(iso_metric_project(m, &t[i], &v[i]), 0);
    }
    both = v[0];
    iso_metric_vector_add(m, &v[1], &both);
    struct iso_template empty = t[2];
    memset(empty.weight, 0, sizeof empty.weight);
    const struct iso_search_entry entries[] = {{5, &t[0]}, {5, &t[1]}, {6, &empty}, {7, &t[2]}};
    struct iso_search_hit hits[3];
    int n = -1;
    assert_int_equal(iso_search_by_metric(&work, entries, 4, &t[3], m, hits, 3, &n), 0);
    assert_int_equal(n, 2);
    for (int i = 0; i < n; i++) {
        const struct iso_metric_vector *person = hits[i].person == 5 ? &both : &v[2];
        assert_true(hits[i].person == 5 || hits[i].person == 7);
        assert_true(fabs(hits[i].score - iso_metric_score(m, person, &v[3])) < 1e-6);
        assert_true(isnan(hits[i].distance_mm));
    }
    assert_true(hits[0].score >= hits[1].score && hits[0].person != hits[1].person);
    assert_int_equal(iso_search_by_metric(&work, entries, 0, &t[3], m, hits, 3, &n), 0);
    assert_int_equal(n, 0);
    n = 17;
    assert_int_equal(iso_search_by_metric(&work, entries, 4, &empty, m, hits, 3, &n), -ENODATA);
    t[1].algorithm++;
    assert_int_equal(iso_search_by_metric(&work, entries, 4, &t[3], m, hits, 3, &n), -EINVAL);
    assert_int_equal(n, 17);
    iso_metric_free(m);
}

/* A metric like the small one with more dimensions. */
static struct iso_metric *wide_metric(int n_dimensions)
{
    struct iso_metric *small = small_metric(), *wide = NULL, shape = *small;
    shape.n_dimensions = n_dimensions;
    assert_int_equal(iso_metric_new(&shape, &wide), 0);
    memcpy(wide->curve_mm, small->curve_mm, (size_t)small->n_curve_values * sizeof(float));
    memcpy(wide->upper_mm, small->upper_mm, (size_t)small->n_nodes * sizeof(float));
    for (int i = 0; i < wide->n_values * n_dimensions; i++) {
        wide->axis[i] = (float)sin(0.7 * i);
    }
    for (int d = 0; d < n_dimensions; d++) {
        wide->between[d] = 3.0f / (float)(d + 1);
        wide->centre[d] = 0.3f * (float)d - 2.0f;
    }
    iso_metric_free(small);
    return wide;
}

/* On x86-64 the numbers are the same to the bit. Elsewhere the compiler may join a product and a
 * sum into one instruction. */
static void assert_same_numbers(const float *a, const float *b, int n)
{
    for (int d = 0; d < n; d++) {
#if defined __x86_64__
        assert_memory_equal(&a[d], &b[d], sizeof a[d]);
#else
        assert_true(fabsf(a[d] - b[d]) <= 1e-5f * fmaxf(fabsf(a[d]), 1.0f));
#endif
    }
}

/* Projects the first n of ISO_METRIC_ROWS templates one by one and together. */
static void assert_rows_are_single_ones(const struct iso_metric *m, int n)
{
    static struct iso_metric_steps steps;
    struct iso_metric_vector one[ISO_METRIC_ROWS], rows[ISO_METRIC_ROWS];
    float mean[ISO_METRIC_ROWS][ISO_METRIC_DIMENSIONS_MAX];
    float *residual_mm = calloc(ISO_METRIC_ROWS * (size_t)m->n_values, sizeof *residual_mm);
    assert_non_null(residual_mm);
    for (int i = 0; i < n; i++) {
        struct iso_template t = small_template(m, 0.1 * i);
        t.points_mm[1][4][i % POINTS][2] += 1.5f + 0.25f * (float)i;
        assert_int_equal(iso_metric_project(m, &t, &one[i]), 0);
        assert_int_equal(iso_metric_residuals(m, &t, &residual_mm[i * m->n_values]), 0);
    }
    iso_metric_steps_fill(m, &steps);
    iso_metric_project_rows(m, &steps, residual_mm, n, rows);
    iso__project_baseline(m, residual_mm, n, mean);
    for (int i = 0; i < n; i++) {
        assert_int_equal(rows[i].n, 1);
        assert_int_equal(rows[i].step, one[i].step);
        assert_same_numbers(&rows[i].weight, &one[i].weight, 1);
        assert_same_numbers(&rows[i].scale, &one[i].scale, 1);
        assert_same_numbers(rows[i].mean, one[i].mean, ISO_METRIC_DIMENSIONS_MAX);
        assert_same_numbers(mean[i], one[i].mean, m->n_dimensions);
    }
    free(residual_mm);
}

/* The sizes are less than a block, one block, and not a multiple of one. */
static void many_templates_are_projected_like_single_ones(void **state)
{
    (void)state;
    const int sizes[] = {1, 7, 8, 16, 19, 150};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        struct iso_metric *m = wide_metric(sizes[i]);
        assert_rows_are_single_ones(m, 1);
        assert_rows_are_single_ones(m, 6);
        assert_rows_are_single_ones(m, ISO_METRIC_ROWS);
        iso_metric_free(m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(residuals_do_not_depend_on_the_pose),
        cmocka_unit_test(it_refuses_what_it_cannot_compare),
        cmocka_unit_test(a_vector_has_the_length_that_is_expected),
        cmocka_unit_test(missing_heights_do_not_count),
        cmocka_unit_test(a_vector_has_the_step_of_its_noise),
        cmocka_unit_test(a_noisy_vector_counts_for_less),
        cmocka_unit_test(a_score_is_the_likelihood_ratio_of_one_person_and_two),
        cmocka_unit_test(a_search_takes_all_templates_of_a_person_together),
        cmocka_unit_test(many_templates_are_projected_like_single_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
