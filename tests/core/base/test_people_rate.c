/* Rates over people, against counts by hand and closed forms of Clopper and Pearson. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/base/people_rate.h"
#include "tests/support/near.h"

static void the_exact_interval_has_closed_forms(void **state)
{
    (void)state;
    const struct iso_interval none = iso_proportion_interval(0.0, 20.0);
    assert_near(none.low, 0.0, 0.0);
    assert_near(none.high, 1.0 - pow(0.025, 1.0 / 20.0), 1e-9);
    const struct iso_interval all = iso_proportion_interval(1.0, 3.5);
    assert_near(all.low, pow(0.025, 1.0 / 3.5), 1e-9);
    assert_near(all.high, 1.0, 0.0);
    const struct iso_interval unknown = iso_proportion_interval(0.0, 0.0);
    assert_near(unknown.high - unknown.low, 1.0, 0.0);
}

/* Ten people are wrong at all of ten trials, ninety at none: p = 0.1, and the sum of squared
 * residuals is 10 * 81 + 90 * 1 = 900. The variance is 100 / 99 * 900 / 1000^2. */
static void dependent_trials_say_less(void **state)
{
    struct iso_people_rate rate = {.people = 0};
    (void)state;
    for (int i = 0; i < 100; i++) {
        iso_people_rate_add(&rate, i < 10 ? 10 : 0, 10);
    }
    assert_near(iso_people_rate_value(&rate), 0.1, 1e-12);
    assert_near(iso_people_rate_effective(&rate), 0.09 / (900.0 / 0.99 * 1e-6), 1e-6);
}

/* Five people are compared in ten pairs, and the four pairs with the first one are wrong. Counted
 * for both people of a pair: 4 of 4 for the first one, 1 of 4 for each other, so p = 0.4. The sum
 * of squared residuals is 2.4^2 + 4 * 0.6^2 = 7.2, the variance 5 / 4 * 7.2 / 20^2 = 0.0225, and
 * the effective number 0.24 / 0.0225 / 4. */
static void pairs_depend_on_two_people(void **state)
{
    struct iso_people_rate rate = {.people = 0};
    (void)state;
    for (int i = 0; i < 5; i++) {
        iso_people_rate_add(&rate, i == 0 ? 4 : 1, 4);
    }
    const struct iso_interval pairs = iso_people_rate_pair_interval(&rate);
    const struct iso_interval expected = iso_proportion_interval(0.4, 0.24 / 0.0225 / 4.0);
    assert_near(pairs.low, expected.low, 1e-9);
    assert_near(pairs.high, expected.high, 1e-9);
    const struct iso_interval single = iso_people_rate_interval(&rate);
    assert_true(pairs.low < single.low && pairs.high > single.high);
}

static void without_an_error_people_count(void **state)
{
    struct iso_people_rate rate = {.people = 0};
    (void)state;
    assert_near(iso_people_rate_interval(&rate).high, 1.0, 0.0);
    assert_near(iso_people_rate_pair_interval(&rate).high, 1.0, 0.0);
    for (int i = 0; i < 7; i++) {
        iso_people_rate_add(&rate, 0, 12);
    }
    const double high = iso_proportion_interval(0.0, 7.0).high;
    assert_near(iso_people_rate_interval(&rate).high, high, 1e-12);
    assert_near(iso_people_rate_pair_interval(&rate).high, high, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_exact_interval_has_closed_forms),
        cmocka_unit_test(dependent_trials_say_less),
        cmocka_unit_test(pairs_depend_on_two_people),
        cmocka_unit_test(without_an_error_people_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
