/* Rates and their intervals, against values from the literature and by hand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/eval/latency.h"
#include "sim/eval/rate.h"

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
    /* What it stands for: no event in n trials is 5% likely at that rate. */
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
        cmocka_unit_test(test_interval_limits),
        cmocka_unit_test(test_rule_of_three),
        cmocka_unit_test(test_latency_quantiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
