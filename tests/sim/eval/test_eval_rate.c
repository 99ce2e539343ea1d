/* Rates and their intervals, compared with values from the literature and by hand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/lab/match/latency.h"
#include "sim/lab/measure/rate.h"
#include "tests/support/near.h"

static void test_value(void **state)
{
    (void)state;
    assert_float_equal(sim_rate_value((struct sim_rate){3, 12}), 0.25, 1e-15);
    assert_true(isnan(sim_rate_value((struct sim_rate){0, 0})));
}

/* Newcombe 1998, table I, method 3: 81/263, 15/148, 0/20, 1/29. */
static void test_interval_newcombe(void **state)
{
    (void)state;
    static const struct {
        struct sim_rate rate;
        double low, high;
    } published[] = {
        {{81, 263}, 0.2553, 0.3662},
        {{15, 148}, 0.0624, 0.1605},
        {{0, 20}, 0.0, 0.1611},
        {{1, 29}, 0.0061, 0.1718},
    };
    for (size_t i = 0; i < sizeof published / sizeof *published; i++) {
        struct sim_interval interval = sim_rate_interval(published[i].rate);
        assert_float_equal(interval.low, published[i].low, 5e-5);
        assert_float_equal(interval.high, published[i].high, 5e-5);
    }
}

/* The same table, method 5; then 0 of n, where (1 - p)^n = 0.025, and its mirror. */
static void test_exact_interval(void **state)
{
    (void)state;
    static const struct {
        struct sim_rate rate;
        double low, high;
    } published[] = {
        {{81, 263}, 0.2527, 0.3676},
        {{15, 148}, 0.0578, 0.1617},
        {{0, 20}, 0.0, 0.1684},
        {{1, 29}, 0.0009, 0.1776},
    };
    for (size_t i = 0; i < sizeof published / sizeof *published; i++) {
        struct sim_interval interval = sim_rate_exact_interval(published[i].rate);
        assert_near(interval.low, published[i].low, 5e-5);
        assert_near(interval.high, published[i].high, 5e-5);
    }
    for (size_t n = 1; n <= 100000; n *= 10) {
        double high = 1.0 - pow(0.025, 1.0 / (double)n);
        struct sim_interval none = sim_rate_exact_interval((struct sim_rate){0, n});
        struct sim_interval all = sim_rate_exact_interval((struct sim_rate){n, n});
        assert_near(none.high, high, 1e-9);
        assert_near(all.low, pow(0.025, 1.0 / (double)n), 1e-9);
    }
    struct sim_interval nothing = sim_rate_exact_interval((struct sim_rate){0, 0});
    assert_near(nothing.low, 0.0, 0.0);
    assert_near(nothing.high, 1.0, 0.0);
}

/* The meaning of the interval's ends, by the sum of the binomial distribution. At the low end, this
 * number of events or more has a probability of 2.5 %. At the high end, this number or fewer has
 * that probability. */
static void test_exact_interval_is_exact(void **state)
{
    (void)state;
    enum { TRIALS = 40 };
    for (size_t events = 1; events < TRIALS; events++) {
        struct sim_interval ends = sim_rate_exact_interval((struct sim_rate){events, TRIALS});
        double choose = 1.0, at_least = 0.0, at_most = 0.0;
        for (size_t k = 0; k <= TRIALS; k++) {
            double rest = (double)(TRIALS - k);
            if (k >= events) {
                at_least += choose * pow(ends.low, (double)k) * pow(1.0 - ends.low, rest);
            }
            if (k <= events) {
                at_most += choose * pow(ends.high, (double)k) * pow(1.0 - ends.high, rest);
            }
            choose *= rest / (double)(k + 1);
        }
        assert_near(at_least, 0.025, 1e-9);
        assert_near(at_most, 0.025, 1e-9);
    }
}

static void test_interval_limits(void **state)
{
    (void)state;
    struct sim_interval none = sim_rate_interval((struct sim_rate){0, 0});
    assert_float_equal(none.low, 0.0, 0.0);
    assert_float_equal(none.high, 1.0, 0.0);
    struct sim_interval all = sim_rate_interval((struct sim_rate){7, 7});
    assert_true(all.low > 0.5 && all.low < 1.0);
    assert_float_equal(all.high, 1.0, 0.0);
}

static void test_rule_of_three(void **state)
{
    (void)state;
    assert_float_equal(sim_rate_smallest(3000), 1e-3, 1e-18);
    assert_float_equal(sim_rate_smallest(2), 1.0, 0.0);
    assert_float_equal(sim_rate_smallest(0), 1.0, 0.0);
    /* The meaning of the bound: at this rate, no event in n trials has a probability of 5%. */
    assert_float_equal(pow(1.0 - sim_rate_smallest(3000), 3000), 0.05, 0.001);
}

static void test_latency_quantiles(void **state)
{
    (void)state;
    int64_t times_ns[100];
    for (int i = 0; i < 100; i++) {
        times_ns[i] = (int64_t)((i * 37) % 100 + 1) * 1000000; /* 1..100 ms, shuffled */
    }
    struct sim_latency latency = sim_latency_of(times_ns, 100);
    assert_int_equal(latency.n, 100);
    assert_float_equal(latency.median_ms, 50.0, 1e-9);
    assert_float_equal(latency.p95_ms, 95.0, 1e-9);
    int64_t one_ns = 2500000;
    assert_float_equal(sim_latency_of(&one_ns, 1).p95_ms, 2.5, 1e-9);
    assert_int_equal(sim_latency_of(NULL, 0).n, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_value),
        cmocka_unit_test(test_interval_newcombe),
        cmocka_unit_test(test_exact_interval),
        cmocka_unit_test(test_exact_interval_is_exact),
        cmocka_unit_test(test_interval_limits),
        cmocka_unit_test(test_rule_of_three),
        cmocka_unit_test(test_latency_quantiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
