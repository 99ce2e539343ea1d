/* The generator of random numbers, compared with the numbers of the reference implementation and
 * with its distributions. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/base/random.h"

enum { N = 200000 };

/* xoshiro256** from state 1, 2, 3, 4: the first numbers of the reference implementation. */
static void numbers_are_those_of_the_reference(void **state)
{
    (void)state;
    static const uint64_t expected[] = {
        UINT64_C(11520),
        UINT64_C(0),
        UINT64_C(1509978240),
        UINT64_C(1215971899390074240),
        UINT64_C(1216172134540287360),
        UINT64_C(607988272756665600),
        UINT64_C(16172922978634559625),
        UINT64_C(8476171486693032832),
    };
    struct sim_random random = {{1, 2, 3, 4}, 0.0, false};
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        assert_true(sim_random_u64(&random) == expected[i]);
    }
}

static void names_hash_as_fnv_1a(void **state)
{
    (void)state;
    assert_true(sim_random_hash("") == UINT64_C(0xcbf29ce484222325));
    assert_true(sim_random_hash("foobar") == UINT64_C(0x85944171f73967e8));
}

static void every_part_of_the_key_matters(void **state)
{
    (void)state;
    struct sim_random a = sim_random_seeded(1, 2, 3), same = sim_random_seeded(1, 2, 3);
    struct sim_random others[] = {sim_random_seeded(2, 2, 3), sim_random_seeded(1, 3, 3),
                                  sim_random_seeded(1, 2, 4), sim_random_seeded(2, 1, 3),
                                  sim_random_seeded(1, 3, 2)};
    uint64_t first = sim_random_u64(&a);
    assert_true(first == sim_random_u64(&same));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        assert_true(first != sim_random_u64(&others[i]));
    }
}

static void normal_deviates_have_the_moments(void **state)
{
    (void)state;
    struct sim_random random = sim_random_seeded(7, 1, 0);
    double sum[5] = {0}, lagged = 0.0, before = 0.0;
    for (int i = 0; i < N; i++) {
        double x = sim_random_normal(&random);
        for (int k = 1; k <= 4; k++) {
            sum[k] += pow(x, k) / N;
        }
        lagged += x * before / N;
        before = x;
    }
    /* Each limit is four standard errors: sqrt of 1, 2, 15 and 96 / N, and sqrt(1 / N). */
    assert_true(fabs(sum[1]) < 4.0 * sqrt(1.0 / N));
    assert_true(fabs(sum[2] - 1.0) < 4.0 * sqrt(2.0 / N));
    assert_true(fabs(sum[3]) < 4.0 * sqrt(15.0 / N));
    assert_true(fabs(sum[4] - 3.0) < 4.0 * sqrt(96.0 / N));
    assert_true(fabs(lagged) < 4.0 * sqrt(1.0 / N));
}

static void ranges_are_kept_and_filled_evenly(void **state)
{
    (void)state;
    struct sim_random random = sim_random_seeded(8, 0, 0);
    int count[7] = {0};
    double least = 1e9, most = -1e9;
    for (int i = 0; i < N; i++) {
        uint32_t k = sim_random_below(&random, 7);
        assert_true(k < 7);
        count[k]++;
        double x = sim_random_between(&random, -2.0, 5.0);
        least = fmin(least, x);
        most = fmax(most, x);
    }
    for (int k = 0; k < 7; k++) {
        assert_true(fabs(count[k] - N / 7.0) < 4.0 * sqrt(N * 6.0 / 49.0));
    }
    assert_true(least >= -2.0 && least < -1.999 && most < 5.0 && most > 4.999);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_those_of_the_reference),
        cmocka_unit_test(names_hash_as_fnv_1a),
        cmocka_unit_test(every_part_of_the_key_matters),
        cmocka_unit_test(normal_deviates_have_the_moments),
        cmocka_unit_test(ranges_are_kept_and_filled_evenly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
