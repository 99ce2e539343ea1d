/* Ranks, CMC and open-set error rates, by hand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/lab/measure/identification.h"

static void test_rank(void **state)
{
    (void)state;
    const double scores[] = {0.3, 0.9, 0.5, 0.5, -INFINITY, -INFINITY};
    assert_int_equal(sim_rank(scores, 6, 1), 1);
    assert_int_equal(sim_rank(scores, 6, 2), 3); /* the equal score counts as better */
    assert_int_equal(sim_rank(scores, 6, 3), 3);
    assert_int_equal(sim_rank(scores, 6, 0), 4);
    assert_int_equal(sim_rank(scores, 6, 4), 6);
    assert_int_equal(sim_rank(scores, 1, 0), 1);
}

static void test_rank_rate_counts_missed(void **state)
{
    (void)state;
    const struct sim_mated_search searches[] = {{1, 5}, {2, 4}, {0, 0}, {1, 3}, {5, 1}};
    assert_int_equal(sim_rank_rate(searches, 5, 1).events, 2);
    assert_int_equal(sim_rank_rate(searches, 5, 4).events, 3);
    assert_int_equal(sim_rank_rate(searches, 5, 100).events, 4); /* never the missed one */
    assert_int_equal(sim_rank_rate(searches, 5, 100).trials, 5);
}

static void test_open_set(void **state)
{
    (void)state;
    const struct sim_mated_search searches[] = {
        {1, 9.0}, {1, 4.0}, {2, 8.0} /* another person is first */, {0, 0.0}, {1, 6.0}};
    double top[] = {5.0, 1.0, 6.0, -INFINITY, 2.0, 3.0, 0.0, 2.0, 1.0, 0.5};
    struct sim_open_set_point point = sim_open_set_at_fpir(searches, 5, top, 10, 0.1);
    /* One of ten may be accepted: the 6. So the threshold is just above 5. */
    assert_true(point.threshold > 5.0 && point.threshold < 5.0 + 1e-9);
    assert_int_equal(point.fpir.events, 1);
    assert_int_equal(point.fpir.trials, 10);
    assert_int_equal(point.fnir.events, 3); /* the 4, the second rank, and the missed one */
    point = sim_open_set_at_fpir(searches, 5, top, 10, 0.0);
    assert_int_equal(point.fpir.events, 0);
    assert_int_equal(point.fnir.events, 4); /* the mated 6 equals the stranger's 6 */
    point = sim_open_set_at_fpir(searches, 5, top, 10, 1.0);
    assert_int_equal(point.fpir.events, 10);
    assert_int_equal(point.fnir.events, 2); /* the second rank and the missed one remain */
}

static void test_open_set_ties_do_not_pass(void **state)
{
    (void)state;
    const struct sim_mated_search searches[] = {{1, 9.0}};
    double top[] = {3.0, 3.0, 3.0, 1.0};
    /* Two of four would be allowed, but three have the same score. */
    struct sim_open_set_point point = sim_open_set_at_fpir(searches, 1, top, 4, 0.5);
    assert_int_equal(point.fpir.events, 0);
    assert_int_equal(point.fnir.events, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rank),
        cmocka_unit_test(test_rank_rate_counts_missed),
        cmocka_unit_test(test_open_set),
        cmocka_unit_test(test_open_set_ties_do_not_pass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
