/* Axes: the normal quantile compared with tables, places and ticks calculated by hand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/lab/draw/scale.h"

static void test_normal_quantile(void **state)
{
    (void)state;
    /* Abramowitz and Stegun, table 26.5 and 26.6. */
    assert_float_equal(sim_normal_quantile(0.5), 0.0, 1e-12);
    assert_float_equal(sim_normal_quantile(0.975), 1.959964, 1e-6);
    assert_float_equal(sim_normal_quantile(0.9), 1.281552, 1e-6);
    assert_float_equal(sim_normal_quantile(1e-3), -3.090232, 1e-6);
    for (double p = 1e-12; p < 1.0; p = p < 0.01 ? p * 10.0 : p + 0.07) {
        double z = sim_normal_quantile(p);
        double ratio = 0.5 * erfc(-z / sqrt(2.0)) / p;
        assert_float_equal(ratio, 1.0, 1e-5); /* 1e-7 of z, times z^2 */
    }
}

static void test_places(void **state)
{
    (void)state;
    const struct sim_axis linear = {"", SIM_SCALE_LINEAR, -2.0, 6.0};
    assert_float_equal(sim_axis_place(&linear, 0.0), 0.25, 1e-12);
    assert_float_equal(sim_axis_place(&linear, 99.0), 1.0, 0.0);
    const struct sim_axis log = {"", SIM_SCALE_LOG, 1e-4, 1.0};
    assert_float_equal(sim_axis_place(&log, 1e-3), 0.25, 1e-12);
    assert_float_equal(sim_axis_place(&log, 0.0), 0.0, 0.0);
    const struct sim_axis normal = {"", SIM_SCALE_NORMAL, 0.02275013, 0.5}; /* z = -2 .. 0 */
    assert_float_equal(sim_axis_place(&normal, 0.1586553), 0.5, 1e-6);      /* z = -1 */
}

static void test_ticks(void **state)
{
    (void)state;
    struct sim_tick ticks[SIM_TICKS_MAX];
    const struct sim_axis linear = {"", SIM_SCALE_LINEAR, -1.3, 4.1};
    assert_int_equal(sim_axis_ticks(&linear, ticks), 6);
    assert_float_equal(ticks[0].value, -1.0, 1e-12);
    assert_string_equal(ticks[1].label, "0"); /* not "-0" */
    assert_string_equal(ticks[5].label, "4");
    const struct sim_axis log = {"", SIM_SCALE_LOG, 1e-4, 0.5};
    assert_int_equal(sim_axis_ticks(&log, ticks), 4);
    assert_string_equal(ticks[3].label, "0.1");
    const struct sim_axis normal = {"", SIM_SCALE_NORMAL, 1e-4, 0.5};
    assert_int_equal(sim_axis_ticks(&normal, ticks), 9);
    assert_string_equal(ticks[0].label, "0.01 %");
    assert_string_equal(ticks[8].label, "40 %");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_normal_quantile),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_ticks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
