/* Verification error rates, compared with counts by hand and with normally distributed scores. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "sim/lab/draw/scale.h"
#include "sim/lab/measure/det.h"

static double normal_cdf(double z)
{
    return 0.5 * erfc(-z / sqrt(2.0));
}

/* 4 mated and 5 non-mated scores, unsorted. One of each has the value 5. */
static struct sim_score few_mated[] = {{9, 0}, {5, 1}, {7, 0}, {2, 1}};
static struct sim_score few_non_mated[] = {{1, 0}, {5, 0}, {3, 1}, {4, 1}, {0, 1}};

static struct sim_scores few(void)
{
    struct sim_scores scores = {few_mated, few_non_mated, 4, 5};
    sim_scores_sort(&scores);
    return scores;
}

static void test_points_by_hand(void **state)
{
    (void)state;
    struct sim_scores scores = few();
    struct sim_det_point points[10];
    size_t n = sim_det_points(&scores, NULL, points);
    static const struct sim_det_point expected[] = {
        {0, 1.0, 0.0},  {1, 0.8, 0.0}, {2, 0.6, 0.0},  {3, 0.6, 0.25},       {4, 0.4, 0.25},
        {5, 0.2, 0.25}, {7, 0.0, 0.5}, {9, 0.0, 0.75}, {INFINITY, 0.0, 1.0},
    };
    assert_int_equal(n, sizeof expected / sizeof *expected);
    for (size_t i = 0; i + 1 < n; i++) {
        assert_float_equal(points[i].threshold, expected[i].threshold, 0.0);
        assert_float_equal(points[i].fmr, expected[i].fmr, 1e-15);
        assert_float_equal(points[i].fnmr, expected[i].fnmr, 1e-15);
    }
    assert_true(isinf(points[n - 1].threshold));
    /* Between (0.4, 0.25) and (0.2, 0.25): they are equal at 0.25. */
    assert_float_equal(sim_det_eer(points, n), 0.25, 1e-15);
    assert_float_equal(sim_det_at_fmr(points, n, 0.4).fnmr, 0.25, 1e-15);
    assert_float_equal(sim_det_at_fmr(points, n, 0.4).threshold, 4.0, 0.0);
    assert_float_equal(sim_det_at_fmr(points, n, 0.19).fnmr, 0.5, 1e-15);
    assert_float_equal(sim_det_at_fmr(points, n, 1.0).fnmr, 0.0, 1e-15);
}

static void test_copies_count_people_again(void **state)
{
    (void)state;
    struct sim_scores scores = few();
    const uint32_t copies[] = {3, 0}; /* person 0 three times, person 1 never */
    struct sim_det_point points[10];
    size_t n = sim_det_points(&scores, copies, points);
    /* Person 0 has the mated scores 7 and 9 and the non-mated scores 1 and 5. */
    assert_float_equal(sim_det_at_fmr(points, n, 0.5).fnmr, 0.0, 1e-15);
    assert_float_equal(sim_det_at_fmr(points, n, 0.0).fnmr, 0.0, 1e-15);
    assert_float_equal(sim_det_eer(points, n), 0.0, 1e-15);
    const uint32_t nobody[] = {0, 0};
    assert_int_equal(sim_det_points(&scores, nobody, points), 0);
}

static void test_perfect_and_hopeless(void **state)
{
    (void)state;
    struct sim_score high[] = {{3, 0}, {4, 1}}, low[] = {{1, 0}, {2, 1}, {2, 0}};
    struct sim_det_point points[6];
    struct sim_scores perfect = {high, low, 2, 3}, hopeless = {low, high, 3, 2};
    size_t n = sim_det_points(&perfect, NULL, points);
    assert_float_equal(sim_det_eer(points, n), 0.0, 1e-15);
    n = sim_det_points(&hopeless, NULL, points);
    assert_float_equal(sim_det_eer(points, n), 1.0, 1e-15);
    assert_float_equal(sim_det_at_fmr(points, n, 0.0).fnmr, 1.0, 1e-15);
}

static void test_lost_pairs_have_no_score(void **state)
{
    (void)state;
    struct sim_score mated[] = {{-INFINITY, 0}, {4, 1}}, other[] = {{-INFINITY, 0}, {2, 1}};
    struct sim_scores scores = {mated, other, 2, 2};
    struct sim_det_point points[5];
    size_t n = sim_det_points(&scores, NULL, points);
    assert_float_equal(sim_det_at_fmr(points, n, 0.0).fnmr, 0.5, 1e-15);
    assert_float_equal(sim_det_at_fmr(points, n, 0.5).fnmr, 0.5, 1e-15);
}

/* Scores at the quantiles of two normal distributions, three units apart. Their error rates are
 * known. */
enum { MATED = 2000, NON_MATED = 30000, PEOPLE = 50 };
static const double apart = 3.0;

/* Each score belongs to a person that does not depend on its rank (Knuth's multiplicative hash). */
static uint32_t scattered(uint32_t i)
{
    return (i * 2654435761u >> 16) % PEOPLE;
}

static struct sim_scores *normal_scores(void)
{
    struct sim_scores *s = calloc(1, sizeof *s);
    s->n_mated = MATED;
    s->n_non_mated = NON_MATED;
    s->mated = calloc(MATED, sizeof *s->mated);
    s->non_mated = calloc(NON_MATED, sizeof *s->non_mated);
    for (uint32_t i = 0; i < MATED; i++) {
        double p = (i + 0.5) / MATED;
        s->mated[i] = (struct sim_score){apart + sim_normal_quantile(p), scattered(i)};
    }
    for (uint32_t i = 0; i < NON_MATED; i++) {
        double p = (i + 0.5) / NON_MATED;
        s->non_mated[i] = (struct sim_score){sim_normal_quantile(p), scattered(i)};
    }
    return s;
}

static void free_scores(struct sim_scores *s)
{
    free(s->mated);
    free(s->non_mated);
    free(s);
}

static void test_normal_scores(void **state)
{
    (void)state;
    struct sim_scores *s = normal_scores();
    struct sim_det_point *points = calloc(MATED + NON_MATED + 1, sizeof *points);
    size_t n = sim_det_points(s, NULL, points);
    assert_float_equal(sim_det_eer(points, n), normal_cdf(-apart / 2.0), 2e-4);
    for (double fmr = 1e-1; fmr > 0.9e-3; fmr /= 10.0) {
        double threshold = -sim_normal_quantile(fmr);
        struct sim_det_point at = sim_det_at_fmr(points, n, fmr);
        assert_float_equal(at.threshold, threshold, 0.02);
        assert_float_equal(at.fnmr, normal_cdf(threshold - apart), 1e-2);
        assert_true(at.fmr <= fmr * (1.0 + 1e-12));
    }
    free(points);
    free_scores(s);
}

static void test_bootstrap_encloses_truth(void **state)
{
    (void)state;
    struct sim_scores *s = normal_scores();
    const double fmr[] = {1e-1, 1e-2};
    struct sim_interval eer, fnmr[2];
    assert_int_equal(sim_det_bootstrap(s, PEOPLE, fmr, 2, &eer, fnmr), 0);
    double truth = normal_cdf(-apart / 2.0);
    assert_true(eer.low < truth && truth < eer.high);
    assert_true(eer.high - eer.low < 0.04);
    for (int k = 0; k < 2; k++) {
        truth = normal_cdf(-sim_normal_quantile(fmr[k]) - apart);
        assert_true(fnmr[k].low < truth && truth < fnmr[k].high);
    }
    struct sim_interval again, fnmr_again[2];
    assert_int_equal(sim_det_bootstrap(s, PEOPLE, fmr, 2, &again, fnmr_again), 0);
    assert_float_equal(again.low, eer.low, 0.0);
    assert_float_equal(fnmr_again[1].high, fnmr[1].high, 0.0);
    free_scores(s);
}

/* All comparisons of one person fail. Resampling over people must count this as one observation. */
static void test_bootstrap_is_by_person(void **state)
{
    (void)state;
    enum { EACH = 50, N = 8 };
    struct sim_score mated[N * EACH], other[N * EACH];
    for (uint32_t i = 0; i < N * EACH; i++) {
        uint32_t person = i / EACH;
        mated[i] = (struct sim_score){person == 0 ? -1.0 : 1.0, person};
        other[i] = (struct sim_score){0.0, person};
    }
    struct sim_scores s = {mated, other, N * EACH, N * EACH};
    sim_scores_sort(&s);
    const double fmr = 0.0;
    struct sim_interval eer, fnmr;
    assert_int_equal(sim_det_bootstrap(&s, N, &fmr, 1, &eer, &fnmr), 0);
    /* 50 of 400 fail. Resampling over comparisons would give 0.10..0.16. */
    assert_float_equal(fnmr.low, 0.0, 1e-15);
    assert_true(fnmr.high >= 0.25);
}

static void test_bootstrap_refuses(void **state)
{
    (void)state;
    struct sim_scores s = few();
    struct sim_interval eer = {7, 7}, fnmr = {7, 7};
    const double fmr = 0.1;
    assert_int_equal(sim_det_bootstrap(&s, 1, &fmr, 1, &eer, &fnmr), -EINVAL);
    s.n_mated = 0;
    assert_int_equal(sim_det_bootstrap(&s, 2, &fmr, 1, &eer, &fnmr), -EINVAL);
    assert_float_equal(eer.low, 7.0, 0.0);
    assert_float_equal(fnmr.high, 7.0, 0.0);
    struct sim_det_point points[10];
    assert_int_equal(sim_det_points(&s, NULL, points), 0);
    assert_true(isnan(sim_det_eer(points, 0)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points_by_hand),
        cmocka_unit_test(test_copies_count_people_again),
        cmocka_unit_test(test_perfect_and_hopeless),
        cmocka_unit_test(test_lost_pairs_have_no_score),
        cmocka_unit_test(test_normal_scores),
        cmocka_unit_test(test_bootstrap_encloses_truth),
        cmocka_unit_test(test_bootstrap_is_by_person),
        cmocka_unit_test(test_bootstrap_refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
