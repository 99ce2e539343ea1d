/* The index of people by a metric that adapts to them: the estimate of its error rates, and
 * templates that do not teach. */
#include <math.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/match/metric_vector.h"
#include "firmware/site/site_index.h"
#include "tests/firmware/site/site_rig.h"

/* Waits for the estimate, which comes some time after the metric. */
static struct iso_site_estimate wait_for_estimate(struct iso_site_index *site)
{
    const struct timespec look = {.tv_nsec = 1000000};
    struct iso_site_estimate estimate;
    assert_int_equal(iso_site_index_settle(site), 0);
    for (int ms = 0; !iso_site_index_estimate(site, &estimate); ms++) {
        assert_true(ms < 10000);
        (void)nanosleep(&look, NULL);
    }
    return estimate;
}

/* The highest score of a template of one of two people with the other one, by the metric in use. */
static double highest_score(const struct iso_site_index *site, const struct iso_metric *metric,
                            const int64_t pair[2])
{
    const struct iso_site_metric *adapted = iso_site_index_metric(site);
    struct iso_metric_vector person, shipped, probe;
    double highest = -INFINITY;
    for (int way = 0; way < 2; way++) {
        assert_int_equal(iso_site_index_person(site, pair[way], &person), 0);
        for (int i = 0; i < TEMPLATES; i++) {
            shipped = probe = site_rig_vector_of(metric, pair[1 - way], i);
            if (adapted) {
                iso_site_turn(adapted, &shipped, &probe);
            }
            highest = fmax(highest, adapted ? iso_site_score(adapted, pair[way], &person, &probe)
                                            : iso_metric_score(metric, &person, &probe));
        }
    }
    return highest;
}

/* The shipped metric with two people, and the adapted one with all. */
static void it_estimates_with_the_metric_in_use(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true);
    struct iso_site_estimate estimate;
    for (int p = 0; p < PEOPLE; p++) {
        site_rig_add_person(site, metric, p);
        if (p == 0) {
            continue;
        }
        estimate = wait_for_estimate(site);
        assert_int_equal(estimate.people, p + 1);
        assert_int_equal(estimate.level[0].same.trials, (p + 1) * TEMPLATES);
        assert_int_equal(estimate.level[0].others.trials, 2 * p * (p + 1) * TEMPLATES);
        const int64_t pair[2] = {estimate.pair[0].person, estimate.pair[0].other};
        const double expected = highest_score(site, metric, pair);
        assert_memory_equal(&estimate.pair[0].score, &expected, sizeof expected);
    }
    iso_site_index_remove(site, 0);
    assert_true(!iso_site_index_estimate(site, &estimate) || estimate.people == PEOPLE - 1);
    iso_site_index_free(site);
}

/* Expects that the metric in use is to the bit that of a site without the templates that do not
 * teach, and that these still identify their people. */
static void expect_taught_by(struct iso_site_index *site, struct iso_site_index *reference)
{
    struct iso_metric_vector found;
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_int_equal(iso_site_index_settle(reference), 0);
    const struct iso_site_metric *own = iso_site_index_metric(site);
    const struct iso_site_metric *expected = iso_site_index_metric(reference);
    assert_non_null(own);
    assert_non_null(expected);
    assert_int_equal(own->people, expected->people);
    assert_memory_equal(own->metric->between, expected->metric->between,
                        DIMENSIONS * sizeof(float));
    assert_memory_equal(own->turn, expected->turn, DIMENSIONS * DIMENSIONS * sizeof(float));
    assert_memory_equal(own->offset, expected->offset, DIMENSIONS * sizeof(float));
    for (int p = 0; p < PEOPLE; p++) {
        assert_int_equal(iso_site_index_person(site, p, &found), 0);
        assert_int_equal(found.n, TEMPLATES);
    }
}

/* Nothing of person 2 teaches, and of person 5 only the first template. */
static void excluded_templates_do_not_teach(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true),
                          *reference = site_rig_new_index(metric, true);
    struct iso_site_record record = {.n_ranges = 0};
    for (int p = 0; p < PEOPLE; p++) {
        site_rig_add_person(site, metric, p);
        for (int i = 0; p != 2 && i < (p == 5 ? 1 : TEMPLATES); i++) {
            site_rig_add_template(reference, metric, p, i);
        }
    }
    iso_site_record_exclude(&record, site_rig_number_of(2, 0), site_rig_number_of(3, 0));
    iso_site_record_exclude(&record, site_rig_number_of(5, 1), site_rig_number_of(6, 0));
    iso_site_index_set_record(site, &record);
    expect_taught_by(site, reference);
    assert_int_equal(iso_site_index_count(site, 0, false), TEMPLATES + TEMPLATES - 1);
    assert_int_equal(iso_site_index_count(site, site_rig_number_of(5, 0), true), 1 + 2 * TEMPLATES);
    assert_int_equal(iso_site_index_state(site).summary.people, PEOPLE - 1);
    iso_site_index_free(site);
    iso_site_index_free(reference);
}

/* Without a template that teaches the shipped metric is used; later templates teach again. */
static void all_can_be_excluded(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true);
    struct iso_site_record record = {.n_ranges = 0};
    for (int p = 0; p < 4; p++) {
        site_rig_add_person(site, metric, p);
    }
    iso_site_record_exclude(&record, 0, site_rig_number_of(4, 0));
    iso_site_index_set_record(site, &record);
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_true(iso_site_is_provisional(iso_site_index_state(site)));
    assert_int_equal(iso_site_index_state(site).summary.people, 0);
    struct iso_metric_vector found;
    assert_int_equal(iso_site_index_person(site, 1, &found), 0);
    assert_int_equal(found.n, TEMPLATES);
    for (int p = 4; p < 7; p++) {
        site_rig_add_person(site, metric, p);
    }
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_false(iso_site_is_provisional(iso_site_index_state(site)));
    assert_int_equal(iso_site_index_state(site).summary.people, 3);
    iso_site_index_free(site);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, site_rig_set_up, site_rig_tear_down)
    const struct CMUnitTest tests[] = {
        TEST(it_estimates_with_the_metric_in_use),
        TEST(excluded_templates_do_not_teach),
        TEST(all_can_be_excluded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
