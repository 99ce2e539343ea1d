/* The error rate that a score promises, compared with the rate that is counted by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/lab/measure/promise.h"

/* A score equal to the threshold is accepted. */
static void counts(void **state)
{
    (void)state;
    struct sim_score non_mated[] = {{-3.0, 0}, {0.5, 1}, {1.0, 0}, {2.5, 1}, {3.0, 0}};
    struct sim_score mated[] = {{-9.0, 0}, {2.0, 1}, {8.0, 0}};
    const struct sim_scores scores = {mated, non_mated, 3, 5};
    static const size_t false_matches[SIM_PROMISES] = {3, 2, 1, 0};
    static const size_t non_matches[SIM_PROMISES] = {1, 1, 2, 2};
    struct sim_promise promises[SIM_PROMISES];
    sim_promises_of(&scores, promises);
    for (int i = 0; i < SIM_PROMISES; i++) {
        assert_int_equal((int)promises[i].score, 1 + i);
        assert_int_equal(promises[i].false_match.events, false_matches[i]);
        assert_int_equal(promises[i].false_match.trials, 5);
        assert_int_equal(promises[i].non_match.events, non_matches[i]);
        assert_int_equal(promises[i].non_match.trials, 3);
    }
}

static void nothing_to_count(void **state)
{
    (void)state;
    const struct sim_scores scores = {NULL, NULL, 0, 0};
    struct sim_promise promises[SIM_PROMISES];
    sim_promises_of(&scores, promises);
    assert_int_equal(promises[0].false_match.trials, 0);
    assert_int_equal(promises[0].non_match.events, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts),
        cmocka_unit_test(nothing_to_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
