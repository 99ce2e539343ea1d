/* What scores promise and keep: likelihood ratios, costs and rates, compared with closed forms and
 * with other ways to compute them. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/base/random.h"
#include "sim/lab/measure/calibration.h"
#include "tests/support/near.h"

/* ---- the likelihood ratio of a score ---- */

static double likelihood_ratio(double score)
{
    return exp(sim_log_likelihood_ratio(score));
}

/* The mean of k p^(k-1) over k of 0..1, by the midpoint rule. */
static double mixture(double p)
{
    enum { STEPS = 20000 };
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double k = (i + 0.5) / STEPS;
        sum += k * pow(p, k - 1.0) / STEPS;
    }
    return sum;
}

static void the_ratio_is_the_mean_over_the_family(void **state)
{
    (void)state;
    for (double score = 0.1; score < 5.0; score += 0.37) {
        const double expected = mixture(pow(10.0, -score));
        assert_near(likelihood_ratio(score) / expected, 1.0, 1e-4);
    }
    assert_near(likelihood_ratio(2.0), 4.45, 0.01);
    assert_near(likelihood_ratio(3.0), 20.8, 0.05);
    assert_near(likelihood_ratio(4.0), 117.7, 0.1);
}

/* If the promise is kept exactly, the mean ratio of non-mated comparisons is 1 (Turing's rule). The
 * variable is u = -ln p, whose density is exp(-u); beyond u = 4000 the rest is 1/4000. */
static void a_kept_promise_has_a_mean_ratio_of_one(void **state)
{
    (void)state;
    const double step = 0.01, end = 4000.0;
    double sum = 0.0;
    for (double u = 0.5 * step; u < end; u += step) {
        sum += step * exp(sim_log_likelihood_ratio(u / log(10.0)) - u);
    }
    assert_near(sum + 1.0 / end, 1.0, 1e-4);
}

static void the_ratio_rises_without_a_step(void **state)
{
    (void)state;
    double before = sim_log_likelihood_ratio(-60.0);
    for (double score = -60.0 + 1e-3; score < 60.0; score += 1e-3) {
        const double now = sim_log_likelihood_ratio(score);
        assert_true(now > before && now < before + 0.003);
        before = now;
    }
    assert_near(likelihood_ratio(0.0), 0.5, 1e-12);
    assert_near(sim_log_likelihood_ratio(-2.0) - sim_log_likelihood_ratio(-3.0), log(10.0), 1e-12);
    assert_true(isinf(sim_log_likelihood_ratio(-INFINITY)));
}

/* ---- Cllr ---- */

/* Score 0 is the ratio 1/2: log2(3) bits for a mated comparison, log2(3/2) for a non-mated one. */
static void cllr_of_one_score(void **state)
{
    struct sim_score mated[] = {{0.0, 0}}, non_mated[] = {{0.0, 0}, {0.0, 1}};
    const struct sim_scores scores = {mated, non_mated, 1, 2};
    double least = 0.0;
    (void)state;
    assert_near(sim_cllr(&scores), 0.5 * (log2(3.0) + log2(1.5)), 1e-12);
    assert_int_equal(sim_cllr_min(&scores, &least), 0);
    assert_near(least, 1.0, 1e-12); /* one score for all says nothing */
}

static void cllr_of_scores_that_are_apart(void **state)
{
    struct sim_score mated[] = {{20.0, 0}, {INFINITY, 0}},
                     non_mated[] = {{-INFINITY, 0}, {-20.0, 1}};
    const struct sim_scores scores = {mated, non_mated, 2, 2};
    double least = 1.0;
    (void)state;
    assert_near(sim_cllr(&scores), 0.0, 1e-9);
    assert_int_equal(sim_cllr_min(&scores, &least), 0);
    assert_near(least, 0.0, 0.0);
}

static void cllr_needs_both_kinds(void **state)
{
    struct sim_score mated[] = {{1.0, 0}};
    const struct sim_scores scores = {mated, NULL, 1, 0};
    struct sim_calibration calibration = {.known = true};
    double least = 0.0;
    (void)state;
    assert_true(isnan(sim_cllr(&scores)));
    assert_int_equal(sim_cllr_min(&scores, &least), 0);
    assert_true(isnan(least));
    assert_int_equal(sim_calibration_of(&scores, 1, 0.0, &calibration), 0);
    assert_false(calibration.known);
}

/* Scores that are no numbers break no memory, and the computation ends. */
static void no_number_ends_no_worse(void **state)
{
    struct sim_score mated[] = {{NAN, 0}, {1.0, 0}, {NAN, 0}}, non_mated[] = {{0.0, 1}, {NAN, 1}};
    const struct sim_scores scores = {mated, non_mated, 3, 2};
    struct sim_det_point points[3 + 2 + 1];
    double least = 0.0;
    (void)state;
    assert_int_equal(sim_cllr_min(&scores, &least), 0);
    assert_in_range(sim_det_points(&scores, NULL, points), 1, 3 + 2 + 1);
}

enum { MATED = 40, NON_MATED = 60, LEVELS = 9 };

/* Draws scores of few values, so that many are equal. */
static void draw(uint64_t seed, struct sim_score *mated, struct sim_score *non_mated,
                 struct sim_scores *scores)
{
    struct sim_random random = sim_random_seeded(seed, 1, 0);
    for (uint32_t i = 0; i < MATED; i++) {
        const uint32_t level = 2 + sim_random_below(&random, LEVELS - 2);
        mated[i] = (struct sim_score){0.5 * (double)level, i % 5};
    }
    for (uint32_t i = 0; i < NON_MATED; i++) {
        non_mated[i] = (struct sim_score){0.5 * (double)sim_random_below(&random, LEVELS - 2),
                                          i % 5};
    }
    *scores = (struct sim_scores){mated, non_mated, MATED, NON_MATED};
    sim_scores_sort(scores);
}

static void count_levels(const struct sim_score *scores, size_t n, double count[LEVELS])
{
    for (size_t i = 0; i < n; i++) {
        count[(size_t)lround(2.0 * scores[i].score)] += 1.0;
    }
}

/* The share of mated comparisons of the levels from a to b. Empty levels have no influence. */
static double share(const double *mated, const double *non_mated, int a, int b)
{
    double m = 0.0, n = 0.0;
    for (int i = a; i <= b; i++) {
        m += mated[i];
        n += non_mated[i];
    }
    return m + n > 0.0 ? m / (m + n) : NAN;
}

/* Isotonic regression by its formula with the least maximum: the value at a place is the greatest
 * over all beginnings of the least mean over all ends (Robertson, Wright and Dykstra 1988). */
static double regressed(const double *mated, const double *non_mated, int at)
{
    double greatest = 0.0;
    for (int a = 0; a <= at; a++) {
        double least = 1.0;
        for (int b = at; b < LEVELS; b++) {
            least = fmin(least, share(mated, non_mated, a, b)); /* fmin ignores NaN */
        }
        greatest = fmax(greatest, least);
    }
    return greatest;
}

static double least_cost_by_formula(const struct sim_scores *scores)
{
    double mated[LEVELS] = {0.0}, non_mated[LEVELS] = {0.0}, cost[2] = {0.0, 0.0};
    count_levels(scores->mated, scores->n_mated, mated);
    count_levels(scores->non_mated, scores->n_non_mated, non_mated);
    for (int i = 0; i < LEVELS; i++) {
        const double p = regressed(mated, non_mated, i);
        const double ratio = p / (1.0 - p) * NON_MATED / MATED;
        cost[0] += mated[i] > 0.0 ? mated[i] * log2(1.0 + 1.0 / ratio) : 0.0;
        cost[1] += non_mated[i] > 0.0 ? non_mated[i] * log2(1.0 + ratio) : 0.0;
    }
    return 0.5 * (cost[0] / MATED + cost[1] / NON_MATED);
}

static void the_least_cost_is_that_of_isotonic_regression(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 50; seed++) {
        struct sim_score mated[MATED], non_mated[NON_MATED];
        struct sim_scores scores;
        double least = NAN;
        draw(seed, mated, non_mated, &scores);
        assert_int_equal(sim_cllr_min(&scores, &least), 0);
        assert_near(least, least_cost_by_formula(&scores), 1e-9);
        assert_true(least <= sim_cllr(&scores) && least > 0.0 && least < 1.0);
    }
}

/* ---- costs ---- */

static void costs_are_those_of_the_counts(void **state)
{
    struct sim_score mated[] = {{1.0, 0}, {2.5, 0}, {3.0, 0}, {5.0, 0}};
    struct sim_score non_mated[] = {{-1.0, 0}, {2.0, 0}, {3.5, 0}, {0.0, 0}};
    struct sim_scores scores = {mated, non_mated, 4, 4};
    struct sim_detection_cost cost[SIM_DETECTION_COSTS];
    (void)state;
    sim_scores_sort(&scores);
    assert_int_equal(sim_detection_costs_of(&scores, cost), 0);
    assert_near(cost[0].weight, 9.9, 1e-9);
    assert_near(cost[1].weight, 99.0, 1e-9);
    assert_near(cost[2].weight, 999.0, 1e-9);
    assert_string_equal(cost[1].level, "balanced");
    assert_near(cost[0].actual, 0.25 + 9.9 * 0.5, 1e-9); /* at 2: misses 1.0, matches 2.0 and 3.5 */
    assert_near(cost[1].actual, 0.5 + 99.0 * 0.25, 1e-9); /* at 3: equal scores match */
    assert_near(cost[2].actual, 0.75, 1e-9);
    for (int i = 0; i < SIM_DETECTION_COSTS; i++) {
        assert_near(cost[i].threshold, 2.0 + i, 0.0);
        assert_near(cost[i].minimum, 0.75, 1e-9); /* only 5.0 is above every non-mated score */
        assert_near(cost[i].best_at, 5.0, 0.0);
    }
}

/* If a non-mated score is the highest, nothing is better than to refuse everybody. */
static void the_least_cost_is_at_most_one(void **state)
{
    struct sim_score mated[] = {{1.0, 0}}, non_mated[] = {{0.0, 0}, {9.0, 0}};
    const struct sim_scores scores = {mated, non_mated, 1, 2};
    struct sim_detection_cost cost[SIM_DETECTION_COSTS];
    (void)state;
    assert_int_equal(sim_detection_costs_of(&scores, cost), 0);
    assert_near(cost[2].minimum, 1.0, 0.0);
    assert_true(isinf(cost[2].best_at));
    assert_near(cost[2].actual, 1.0 + 999.0 * 0.5, 1e-9);
}

/* ---- the curve ---- */

/* Every person keeps the promise exactly: of 1,000 comparisons, one lies in each thousandth. */
static void a_kept_promise_is_measured(void **state)
{
    enum { PEOPLE = 4, EACH = 1000 };
    static struct sim_score non_mated[PEOPLE * EACH];
    const struct sim_scores scores = {NULL, non_mated, 0, PEOPLE * EACH};
    struct sim_promise_point curve[SIM_PROMISE_POINTS];
    (void)state;
    for (uint32_t i = 0; i < PEOPLE * EACH; i++) {
        const uint32_t place = i / PEOPLE;
        non_mated[i] = (struct sim_score){-log10(1.0 - (place + 0.5) / EACH), i % PEOPLE};
    }
    assert_int_equal(sim_promise_curve_of(&scores, PEOPLE, PEOPLE * EACH, curve), 0);
    for (int i = 0; i < SIM_PROMISE_POINTS; i++) {
        assert_near(curve[i].promised, pow(10.0, -0.1 * i), 1e-12);
        assert_near(curve[i].fmr, curve[i].promised, 0.5 / EACH + 1e-9);
        assert_true(curve[i].interval.low <= curve[i].promised);
        assert_true(curve[i].interval.high >= curve[i].promised);
    }
}

/* All false matches are of one of four people. Counts alone would say 25 % +- 3 %. */
static void the_interval_is_of_people(void **state)
{
    enum { PEOPLE = 4, EACH = 200 };
    static struct sim_score non_mated[PEOPLE * EACH];
    const struct sim_scores scores = {NULL, non_mated, 0, PEOPLE * EACH};
    struct sim_promise_point curve[SIM_PROMISE_POINTS], again[SIM_PROMISE_POINTS];
    (void)state;
    for (uint32_t i = 0; i < PEOPLE * EACH; i++) {
        const uint32_t person = i / EACH;
        non_mated[i] = (struct sim_score){person == PEOPLE - 1 ? 3.05 : -1.0, person};
    }
    assert_int_equal(sim_promise_curve_of(&scores, PEOPLE, PEOPLE * EACH, curve), 0);
    assert_int_equal(sim_promise_curve_of(&scores, PEOPLE, PEOPLE * EACH, again), 0);
    assert_near(curve[30].fmr, 0.25, 1e-12); /* score 3 */
    assert_near(curve[30].interval.low, 0.0, 0.0);
    assert_true(curve[30].interval.high >= 0.5);
    assert_near(curve[31].fmr, 0.0, 0.0);
    /* None of the 800 comparisons reaches this score, but the true rate may be above 0. The upper
     * end is that of Wilson's interval. */
    assert_near(curve[31].interval.high, sim_rate_interval((struct sim_rate){0, 800}).high, 1e-12);
    assert_near(again[30].interval.high, curve[30].interval.high, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ratio_is_the_mean_over_the_family),
        cmocka_unit_test(a_kept_promise_has_a_mean_ratio_of_one),
        cmocka_unit_test(the_ratio_rises_without_a_step),
        cmocka_unit_test(cllr_of_one_score),
        cmocka_unit_test(cllr_of_scores_that_are_apart),
        cmocka_unit_test(cllr_needs_both_kinds),
        cmocka_unit_test(no_number_ends_no_worse),
        cmocka_unit_test(the_least_cost_is_that_of_isotonic_regression),
        cmocka_unit_test(costs_are_those_of_the_counts),
        cmocka_unit_test(the_least_cost_is_at_most_one),
        cmocka_unit_test(a_kept_promise_is_measured),
        cmocka_unit_test(the_interval_is_of_people),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
