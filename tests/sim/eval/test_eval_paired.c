/* The paired test, and rates by number of enrolled people, compared with values by hand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/lab/eval/growth.h"
#include "sim/lab/measure/paired.h"

enum { N = 60 };

static struct sim_paired paired(const uint8_t *first, const uint8_t *second, uint32_t per_person)
{
    uint32_t person[N];
    struct sim_paired p;
    for (uint32_t i = 0; i < N; i++) {
        person[i] = i / per_person;
    }
    assert_int_equal(sim_paired_test(first, second, person, N, N / per_person, &p), 0);
    return p;
}

/* Five people have 12 searches each, and one more error each with the second method. So p = 2 / 32.
 */
static void test_every_sign(void **state)
{
    (void)state;
    uint8_t first[N] = {0}, second[N] = {0};
    for (int p = 0; p < 5; p++) {
        second[12 * p + 3] = 1;
    }
    struct sim_paired r = paired(first, second, 12);
    assert_int_equal(r.people, 5);
    assert_int_equal(r.first_better, 5);
    assert_int_equal(r.second_better, 0);
    assert_int_equal(r.second_errors, 5);
    assert_float_equal(r.p, (2.0 / 32.0), 1e-9);
    r = paired(second, first, 12); /* in the other order */
    assert_int_equal(r.second_better, 5);
    assert_float_equal(r.p, (2.0 / 32.0), 1e-9);
    /* The differences are 1, 1, 1, 1, -1. Of 32 choices of signs, 12 have a sum of at least 3 or at
     * most -3. */
    second[12 * 4 + 3] = 0;
    first[12 * 4 + 3] = 1;
    r = paired(first, second, 12);
    assert_float_equal(r.p, (12.0 / 32.0), 1e-9);
}

/* Many errors of one person are no evidence. The same number of errors of 12 people is evidence. */
static void test_people_count_and_not_searches(void **state)
{
    (void)state;
    uint8_t first[N] = {0}, one[N] = {0}, spread[N] = {0};
    memset(one, 1, 12);
    for (int i = 0; i < 12; i++) {
        spread[5 * i] = 1;
    }
    assert_float_equal(paired(first, one, 12).p, 1.0, 1e-12);
    assert_float_equal(paired(first, spread, 5).p, (2.0 / 4096.0), 1e-9);
    assert_float_equal(paired(one, one, 12).p, 1.0, 0.0);
}

/* 20 people differ, so that signs are drawn at random. 15 against 5 is exactly 2 P(X >= 15) =
 * 0.0414. */
static void test_drawn_signs(void **state)
{
    (void)state;
    uint8_t first[N] = {0}, second[N] = {0};
    for (int p = 0; p < 20; p++) {
        (p < 15 ? second : first)[3 * p] = 1;
    }
    struct sim_paired r = paired(first, second, 3), again = paired(first, second, 3);
    assert_float_equal(r.p, 0.0414, 0.003);
    assert_float_equal(r.p, again.p, 0.0);
}

static void test_missed(void **state)
{
    (void)state;
    assert_float_equal(sim_growth_missed(10, 0, 5), 1.0, 0.0);
    assert_float_equal(sim_growth_missed(10, 1, 3), 0.7, 1e-12);
    assert_float_equal(sim_growth_missed(10, 2, 3), (0.7 * 6.0 / 9.0), 1e-6);
    assert_float_equal(sim_growth_missed(10, 1, 10), 0.0, 0.0);
    assert_float_equal(sim_growth_missed(10, 8, 3), 0.0, 0.0);
}

/* 20 people are enrolled. One of two strangers scores 5 with one person. In the one mated search,
 * one other person (4) is before the mate (3). */
static void test_growth(void **state)
{
    (void)state;
    enum { PEOPLE = 20, PROBES = 3 };
    double score[PROBES * PEOPLE];
    for (int i = 0; i < PROBES * PEOPLE; i++) {
        score[i] = 0.001 * i;
    }
    score[7] = 5.0;
    score[2 * PEOPLE + 11] = 3.0;
    score[2 * PEOPLE + 12] = 4.0;
    size_t n_templates_of[PEOPLE];
    for (int p = 0; p < PEOPLE; p++) {
        n_templates_of[p] = 1;
    }
    enum sim_probe_kind kind[] = {SIM_PROBE_STRANGER, SIM_PROBE_STRANGER, SIM_PROBE_MATED};
    struct sim_mated_search searches[] = {{2, 3.0}};
    const struct sim_gallery gallery = {.n_people = PEOPLE, .n_templates_of = n_templates_of};
    const struct sim_matches matches = {.n_probes = PROBES, .n_people = PEOPLE, .score = score};
    const struct sim_analysis analysis = {
        .kind = kind,
        .identification = {.n_searches = 1, .n_strangers = 2, .searches = searches},
    };
    struct sim_growth g;
    assert_int_equal(sim_growth_of(&gallery, &matches, &analysis, 0.5, &g), 0);
    assert_int_equal(g.n, 2);
    assert_int_equal(g.points[0].n_people, 10);
    assert_int_equal(g.points[1].n_people, PEOPLE);
    /* With all people enrolled, one stranger of two may be accepted: the threshold is just above
     * the other's best score. */
    assert_float_equal(g.threshold, 0.039, 1e-9);
    assert_float_equal(g.points[1].fpir, 0.5, 1e-12);
    assert_float_equal(g.points[0].fpir, 0.25, 1e-12); /* this person is one of 10 of 20 */
    assert_float_equal(g.points[1].fnir, 1.0, 1e-12);
    /* The mate is found if the other person is not one of the 9 drawn from the 19 others. */
    assert_float_equal(g.points[0].fnir, (9.0 / 19.0), 1e-6);
    assert_true(g.points[0].fnir_at_fpir <= g.points[1].fnir_at_fpir);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_sign),  cmocka_unit_test(test_people_count_and_not_searches),
        cmocka_unit_test(test_drawn_signs), cmocka_unit_test(test_missed),
        cmocka_unit_test(test_growth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
