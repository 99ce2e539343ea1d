/* The error rates of a site, against counts by hand. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/site/site_estimate.h"
#include "tests/firmware/site/site_rig.h"
#include "tests/support/near.h"

enum { ADA = 3, BEN = 5, CAM = 8, DAN = 13 };

/* People vary so much more than templates of one person that every score is far from all levels. */
static int set_up(void **state)
{
    (void)site_rig_set_up(state);
    struct iso_metric *metric = *state;
    for (int d = 0; d < DIMENSIONS; d++) {
        metric->between[d] = 100.0f;
    }
    return 0;
}

/* A template of the face `face`. */
static struct iso_metric_vector capture_of(int face, int i)
{
    struct iso_metric_vector vector = {.n = 1};
    for (int d = 0; d < DIMENSIONS; d++) {
        vector.mean[d] = (float)(12.0 * sin(17.0 * face + 3.0 * d) + 0.3 * sin(7.0 * i + 5.0 * d));
    }
    return vector;
}

/* People in an array; the reader stops at the row `change_at`, as if the people had changed. */
struct crowd {
    int n, change_at, reads;
    struct {
        int64_t number;
        int n, face[ISO_INDEX_TEMPLATES_MAX];
    } person[150];
};

static void add_person(struct crowd *crowd, int64_t number, int n, const int *face)
{
    crowd->person[crowd->n].number = number;
    crowd->person[crowd->n].n = n;
    memcpy(crowd->person[crowd->n++].face, face, (size_t)n * sizeof *face);
}

static int read_person(void *context, bool teaching, size_t *at, struct iso_site_person *out)
{
    struct crowd *crowd = context;
    assert_false(teaching); /* all templates are compared, also those that do not teach */
    if (crowd->change_at > 0 && ++crowd->reads == crowd->change_at) {
        return -ECANCELED;
    }
    if (*at >= (size_t)crowd->n) {
        return 0;
    }
    out->number = crowd->person[*at].number;
    out->n = crowd->person[*at].n;
    for (int i = 0; i < out->n; i++) {
        out->captures[i] = capture_of(crowd->person[*at].face[i], i);
    }
    ++*at;
    return 1;
}

static int estimate(const struct iso_metric *metric, struct crowd *crowd,
                    struct iso_site_estimate *out)
{
    struct iso_site_work *work = calloc(1, sizeof *work);
    assert_non_null(work);
    work->metric = metric;
    work->reader = (struct iso_site_reader){read_person, crowd};
    iso_metric_steps_fill(metric, &work->steps);
    const int error = iso_site_estimate_make(work, NULL, out);
    free(work);
    return error;
}

/* Ada and Ben have one face. Cam's two templates are of two faces. */
static void fill_four(struct crowd *crowd)
{
    add_person(crowd, ADA, 2, (const int[]){1, 1});
    add_person(crowd, BEN, 1, (const int[]){1});
    add_person(crowd, CAM, 2, (const int[]){2, 3});
    add_person(crowd, DAN, 1, (const int[]){4});
}

/* Mated: Ada's two templates find each other, and Cam's two do not. Non-mated, in both directions:
 * Ada with Ben 3, Cam 4, Dan 3; Ben with Cam 3, Dan 2; Cam with Dan 3. The first three are errors.
 */
static void rates_are_those_of_a_count_by_hand(void **state)
{
    struct crowd crowd = {.n = 0};
    struct iso_site_estimate out;
    fill_four(&crowd);
    assert_int_equal(estimate(*state, &crowd, &out), 0);
    assert_int_equal(out.people, 4);
    assert_int_equal(out.repeated, 2);
    for (int l = 0; l < ISO_SITE_LEVELS; l++) {
        assert_near(out.level[l].score, 2.0 + l, 0.0);
        assert_int_equal(out.level[l].same.errors, 2);
        assert_int_equal(out.level[l].same.trials, 4);
        assert_int_equal(out.level[l].same.people, 2);
        assert_int_equal(out.level[l].others.errors, 2 * 3);
        assert_int_equal(out.level[l].others.trials, 2 * 18);
        assert_int_equal(out.level[l].others.people, 4);
        assert_near(out.level[l].others.errors_squared, 9 + 9, 0.0);
        assert_near(out.level[l].others.errors_times_trials, 3 * 10 + 3 * 8, 0.0);
        assert_near(out.level[l].others.trials_squared, 100 + 64 + 100 + 64, 0.0);
    }
}

static void pairs_come_by_falling_score(void **state)
{
    struct crowd crowd = {.n = 0};
    struct iso_site_estimate out;
    fill_four(&crowd);
    assert_int_equal(estimate(*state, &crowd, &out), 0);
    assert_int_equal(out.n_pairs, 6);
    assert_int_equal(out.pair[0].person, ADA);
    assert_int_equal(out.pair[0].other, BEN);
    assert_true(out.pair[0].score > 4.0 && out.pair[1].score < 1.0);
    for (int i = 1; i < out.n_pairs; i++) {
        assert_true(out.pair[i].person < out.pair[i].other);
        assert_true(out.pair[i].score <= out.pair[i - 1].score);
    }
}

/* Of more than a hundred people the first hundred are compared, three templates of each with the
 * others, and the pairs of the highest scores are kept: the two of one face come last. */
static void a_large_site_is_sampled(void **state)
{
    struct crowd *crowd = calloc(1, sizeof *crowd);
    struct iso_site_estimate out;
    assert_non_null(crowd);
    for (int p = 0; p < 120; p++) {
        const int face = p == 99 ? 98 : p;
        add_person(crowd, p, 5, (const int[]){face, face, face, face, face});
    }
    assert_int_equal(estimate(*state, crowd, &out), 0);
    assert_int_equal(out.people, ISO_SITE_SAMPLE_MAX);
    assert_int_equal(out.level[0].same.trials, 100 * 5);
    assert_int_equal(out.level[0].others.trials, 2 * 100 * 99 * 3);
    assert_int_equal(out.n_pairs, ISO_SITE_PAIRS_MAX);
    assert_int_equal(out.pair[0].person, 98);
    assert_int_equal(out.pair[0].other, 99);
    for (int i = 1; i < out.n_pairs; i++) {
        assert_true(out.pair[i].score <= out.pair[i - 1].score);
    }
    free(crowd);
}

static void few_people_have_few_comparisons(void **state)
{
    struct crowd crowd = {.n = 0};
    struct iso_site_estimate out;
    assert_int_equal(estimate(*state, &crowd, &out), 0);
    assert_int_equal(out.people, 0);
    add_person(&crowd, ADA, 1, (const int[]){1});
    assert_int_equal(estimate(*state, &crowd, &out), 0);
    assert_int_equal(out.people, 1);
    assert_int_equal(out.repeated, 0);
    assert_int_equal(out.level[0].same.people, 0);
    assert_int_equal(out.level[0].others.people, 0);
    assert_int_equal(out.n_pairs, 0);
}

static void a_change_of_people_ends_it(void **state)
{
    struct iso_site_estimate out;
    for (int at = 1; at <= 9; at++) { /* five reads of the sample, and four between the people */
        struct crowd crowd = {.change_at = at};
        fill_four(&crowd);
        assert_int_equal(estimate(*state, &crowd, &out), -ECANCELED);
    }
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, set_up, site_rig_tear_down)
    const struct CMUnitTest tests[] = {
        TEST(rates_are_those_of_a_count_by_hand),
        TEST(pairs_come_by_falling_score),
        TEST(a_large_site_is_sampled),
        TEST(few_people_have_few_comparisons),
        TEST(a_change_of_people_ends_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
