/* The time that a grant needs, compared with the time that it may take. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/visit/stale_budget.h"

static struct iso_stale_budget budget_of(double rate_hz, int work_ms)
{
    struct iso_stale_budget budget = {.stale_ns = ISO_NS_PER_S, .agree = 2, .rate_hz = rate_hz};
    if (work_ms > 0) {
        iso_stale_budget_measure(&budget, work_ms * ISO_NS_PER_MS);
    }
    return budget;
}

static void the_parts_are_added(void **state)
{
    const struct iso_stale_budget budget = budget_of(10, 100);
    const struct iso_stale_budget unknown = budget_of(0, 0);
    (void)state;
    assert_int_equal(iso_stale_budget_needed_ns(&budget), (200 + 250 + 100) * ISO_NS_PER_MS);
    assert_int_equal(iso_stale_budget_needed_ns(&unknown), 250 * ISO_NS_PER_MS);
}

static void a_usual_camera_has_enough(void **state)
{
    const struct iso_stale_budget budget = budget_of(30, 150);
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_false(iso_stale_budget_is_tight(&budget, &fault));
    assert_string_equal(fault.text, "");
}

static void a_slow_camera_has_not_enough_time(void **state)
{
    struct iso_stale_budget budget = budget_of(5, 0);
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_false(iso_stale_budget_is_tight(&budget, &fault)); /* 650 ms */
    iso_stale_budget_measure(&budget, 180 * ISO_NS_PER_MS);
    assert_true(iso_stale_budget_is_tight(&budget, &fault));
    assert_string_equal(fault.text,
                        "a grant may need 830 ms (2 frames at 5 a second, 250 ms for its record, "
                        "180 ms of work), and [sensor] stale_ms is 1000: enrolled people may be "
                        "refused as stale");
}

/* One late frame changes little. A machine that stays slow is detected. */
static void the_working_time_is_a_mean(void **state)
{
    struct iso_stale_budget budget = budget_of(30, 50);
    (void)state;
    iso_stale_budget_measure(&budget, 850 * ISO_NS_PER_MS);
    assert_false(iso_stale_budget_is_tight(&budget, NULL));
    for (int i = 0; i < 50; i++) {
        iso_stale_budget_measure(&budget, 850 * ISO_NS_PER_MS);
    }
    assert_true(iso_stale_budget_is_tight(&budget, NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_parts_are_added),
        cmocka_unit_test(a_usual_camera_has_enough),
        cmocka_unit_test(a_slow_camera_has_not_enough_time),
        cmocka_unit_test(the_working_time_is_a_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
