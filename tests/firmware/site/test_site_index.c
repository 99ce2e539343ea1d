/* The index of people by a metric that adapts to them: it is what core/match/site.h computes from
 * the present people, whatever happened before; and it has every change at once. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/match/metric_vector.h"
#include "firmware/site/site_index.h"

enum { DIMENSIONS = 12, PEOPLE = 8, TEMPLATES = 3 };

static int set_up(void **state)
{
    const struct iso_metric shape = {
        .landmarks = 1,
        .n_radii = 2,
        .n_points = 5,
        .n_dimensions = DIMENSIONS,
        .weight_min = 0.25f,
        .gain = 0.5f,
    };
    struct iso_metric *metric = NULL;
    assert_int_equal(iso_metric_new(&shape, &metric), 0);
    for (int d = 0; d < DIMENSIONS; d++) {
        metric->between[d] = 6.0f / (float)(d + 1);
        metric->axis[2 * d * DIMENSIONS + d] = 1.0f;
    }
    *state = metric;
    return 0;
}

static int tear_down(void **state)
{
    iso_metric_free(*state);
    return 0;
}

/* The vector of one template of a person. */
static struct iso_metric_vector vector_of(const struct iso_metric *metric, int64_t person, int i)
{
    struct iso_metric_vector vector = {.n = 1};
    struct iso_metric_steps steps;
    for (int d = 0; d < DIMENSIONS; d++) {
        const double own = sin(17.0 * (double)person + 3.0 * d), noise = sin(7.0 * i + 5.0 * d);
        vector.mean[d] = (float)(1.5 + 2.0 * own + 0.7 * noise);
    }
    iso_metric_steps_fill(metric, &steps);
    iso_metric_vector_judge(metric, &steps, &vector);
    return vector;
}

static struct iso_site_index *new_index(const struct iso_metric *metric, bool adapt)
{
    struct iso_site_index *site = NULL;
    assert_int_equal(iso_site_index_new(metric, adapt, &site), 0);
    assert_int_equal(iso_site_index_start(site), 0);
    return site;
}

static uint64_t number_of(int64_t person, int i)
{
    return 100 * (uint64_t)person + (uint64_t)i;
}

static void add_template(struct iso_site_index *site, const struct iso_metric *metric,
                         int64_t person, int i)
{
    const struct iso_metric_vector vector = vector_of(metric, person, i);
    assert_int_equal(iso_site_index_reserve(site, 1), 0);
    assert_int_equal(iso_site_index_add(site, person, number_of(person, i), &vector), 0);
}

static void add_person(struct iso_site_index *site, const struct iso_metric *metric, int64_t person)
{
    for (int i = 0; i < TEMPLATES; i++) {
        add_template(site, metric, person, i);
    }
}

/* Shows the people who are here to the statistics, in the first pass or in the second one. */
static void pass_people(struct iso_site *statistics, const struct iso_metric *metric,
                        const bool *is_here, bool second)
{
    struct iso_metric_vector captures[TEMPLATES];
    for (int p = 0; p < PEOPLE; p++) {
        for (int i = 0; i < TEMPLATES; i++) {
            captures[i] = vector_of(metric, p, i);
        }
        if (is_here[p]) {
            assert_int_equal(second ? iso_site_review(statistics, captures, TEMPLATES)
                                    : iso_site_add(statistics, p, captures, TEMPLATES),
                             0);
        }
    }
}

/* What core computes from these people. */
static struct iso_site_metric adapted_to(const struct iso_metric *metric, const bool *is_here)
{
    struct iso_site *statistics = NULL;
    struct iso_site_metric adapted;
    assert_int_equal(iso_site_new(metric, &statistics), 0);
    pass_people(statistics, metric, is_here, false);
    assert_int_equal(iso_site_find_directions(statistics), 0);
    pass_people(statistics, metric, is_here, true);
    assert_int_equal(iso_site_adapt(statistics, metric, &adapted), 0);
    iso_site_free(statistics);
    return adapted;
}

/* Expects the person's vector by this metric in the index. */
static void expect_person(const struct iso_site_index *site, const struct iso_metric *metric,
                          const struct iso_site_metric *adapted, int64_t person)
{
    struct iso_metric_vector all = {.n = 0}, found, one;
    for (int i = 0; i < TEMPLATES; i++) {
        one = vector_of(metric, person, i);
        if (adapted) {
            const struct iso_metric_vector shipped = one;
            iso_site_turn(adapted, &shipped, &one);
        }
        iso_metric_vector_add(adapted ? adapted->metric : metric, &one, &all);
    }
    assert_int_equal(iso_index_find(iso_site_index_current(site), person, &found), 0);
    assert_int_equal(found.n, TEMPLATES);
    assert_int_equal(found.step, all.step);
    assert_memory_equal(&found.scale, &all.scale, sizeof all.scale);
    assert_memory_equal(found.mean, all.mean, DIMENSIONS * sizeof(float));
}

/* Expects what core computes from these people, to the bit. */
static void expect_adapted(struct iso_site_index *site, const struct iso_metric *metric,
                           const bool *is_here)
{
    struct iso_site_metric adapted = adapted_to(metric, is_here);
    struct iso_metric_vector none;
    assert_int_equal(iso_site_index_settle(site), 0);
    const struct iso_site_metric *own = iso_site_index_metric(site);
    assert_non_null(own);
    assert_int_equal(own->people, adapted.people);
    assert_memory_equal(own->metric->between, adapted.metric->between, DIMENSIONS * sizeof(float));
    assert_memory_equal(own->offset, adapted.offset, DIMENSIONS * sizeof(float));
    for (int p = 0; p < PEOPLE; p++) {
        if (is_here[p]) {
            expect_person(site, metric, &adapted, p);
        } else {
            assert_int_equal(iso_index_find(iso_site_index_current(site), p, &none), -ENOENT);
        }
    }
    iso_site_metric_free(&adapted);
}

static void two_people_do_not_adapt_it(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, true);
    add_person(site, metric, 0);
    add_person(site, metric, 1);
    assert_int_equal(iso_site_index_settle(site), 0);
    const struct iso_site_state after = iso_site_index_state(site);
    assert_true(iso_site_is_provisional(after));
    assert_false(after.due);
    assert_int_equal(after.summary.people, 2);
    assert_int_equal(after.summary.taught, 2);
    assert_null(iso_site_index_metric(site));
    expect_person(site, metric, NULL, 0);
    expect_person(site, metric, NULL, 1);
    iso_site_index_free(site);
}

static void it_adapts_to_the_present_people(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, true);
    bool is_here[PEOPLE] = {false};
    for (int p = 0; p < PEOPLE; p++) {
        add_person(site, metric, p);
        is_here[p] = true;
        if (p + 1 >= ISO_SITE_PEOPLE_MIN) {
            expect_adapted(site, metric, is_here);
        }
    }
    assert_false(iso_site_is_provisional(iso_site_index_state(site)));
    for (int p = 0; p < PEOPLE - ISO_SITE_PEOPLE_MIN; p++) {
        iso_site_index_remove(site, p);
        is_here[p] = false;
        expect_adapted(site, metric, is_here);
    }
    iso_site_index_remove(site, PEOPLE - 1);
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_null(iso_site_index_metric(site));
    expect_person(site, metric, NULL, PEOPLE - 2);
    iso_site_index_free(site);
}

/* The templates of people come in turns, and in another order of people. */
static void the_order_does_not_matter(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, true);
    bool is_here[PEOPLE];
    for (int i = 0; i < TEMPLATES; i++) {
        for (int p = PEOPLE - 1; p >= 0; p--) {
            add_template(site, metric, p, i);
            is_here[p] = true;
        }
    }
    expect_adapted(site, metric, is_here);
    iso_site_index_free(site);
}

static void a_change_is_there_at_once(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, true);
    struct iso_metric_vector found;
    bool is_here[PEOPLE] = {true, true, true, false};
    for (int p = 0; p < 3; p++) {
        add_person(site, metric, p);
    }
    expect_adapted(site, metric, is_here);
    const struct iso_site_metric *before = iso_site_index_metric(site);
    const struct iso_metric *metric_before = before->metric;
    add_person(site, metric, 3);
    iso_site_index_remove(site, 1);
    assert_ptr_equal(iso_site_index_metric(site)->metric, metric_before);
    expect_person(site, metric, before, 3);
    assert_int_equal(iso_index_find(iso_site_index_current(site), 1, &found), -ENOENT);
    is_here[1] = false;
    is_here[3] = true;
    expect_adapted(site, metric, is_here);
    iso_site_index_free(site);
}

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
        assert_int_equal(iso_index_find(iso_site_index_current(site), pair[way], &person), 0);
        for (int i = 0; i < TEMPLATES; i++) {
            shipped = probe = vector_of(metric, pair[1 - way], i);
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
    struct iso_site_index *site = new_index(metric, true);
    struct iso_site_estimate estimate;
    for (int p = 0; p < PEOPLE; p++) {
        add_person(site, metric, p);
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

/* The thread is disturbed at any moment, and searches go on. */
static void it_follows_many_changes(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, true);
    bool is_here[PEOPLE] = {false};
    int followed = 0;
    for (unsigned step = 0; step < 400; step++) {
        const int p = (int)(step * 2654435761U >> 16) % PEOPLE;
        const struct iso_metric_vector shipped = vector_of(metric, p, 0);
        struct iso_metric_vector probe = shipped;
        struct iso_search_hit hits[PEOPLE];
        int n = 0, expected = 0;
        if (is_here[p]) {
            iso_site_index_remove(site, p);
        } else {
            add_person(site, metric, p);
        }
        is_here[p] = !is_here[p];
        followed += iso_site_index_follow(site);
        const struct iso_site_metric *adapted = iso_site_index_metric(site);
        if (adapted) {
            iso_site_turn(adapted, &shipped, &probe);
        }
        assert_int_equal(iso_index_search(iso_site_index_current(site), &probe, hits, PEOPLE, &n),
                         0);
        for (int k = 0; k < PEOPLE; k++) {
            expected += is_here[k];
        }
        assert_int_equal(n, expected);
        if (step % 20 == 0) {
            followed += iso_site_index_settle(site) == 0;
        }
    }
    assert_true(followed > 0);
    for (int p = 0; p < PEOPLE; p++) {
        if (!is_here[p]) {
            add_person(site, metric, p);
            is_here[p] = true;
        }
    }
    expect_adapted(site, metric, is_here);
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
        assert_int_equal(iso_index_find(iso_site_index_current(site), p, &found), 0);
        assert_int_equal(found.n, TEMPLATES);
    }
}

/* Nothing of person 2 teaches, and of person 5 only the first template. */
static void excluded_templates_do_not_teach(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, true), *reference = new_index(metric, true);
    struct iso_site_record record = {.n_ranges = 0};
    for (int p = 0; p < PEOPLE; p++) {
        add_person(site, metric, p);
        for (int i = 0; p != 2 && i < (p == 5 ? 1 : TEMPLATES); i++) {
            add_template(reference, metric, p, i);
        }
    }
    iso_site_record_exclude(&record, number_of(2, 0), number_of(3, 0));
    iso_site_record_exclude(&record, number_of(5, 1), number_of(6, 0));
    iso_site_index_set_record(site, &record);
    expect_taught_by(site, reference);
    assert_int_equal(iso_site_index_count(site, 0, false), TEMPLATES + TEMPLATES - 1);
    assert_int_equal(iso_site_index_count(site, number_of(5, 0), true), 1 + 2 * TEMPLATES);
    assert_int_equal(iso_site_index_state(site).summary.people, PEOPLE - 1);
    iso_site_index_free(site);
    iso_site_index_free(reference);
}

/* Without a template that teaches the shipped metric is used; later templates teach again. */
static void all_can_be_excluded(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, true);
    struct iso_site_record record = {.n_ranges = 0};
    for (int p = 0; p < 4; p++) {
        add_person(site, metric, p);
    }
    iso_site_record_exclude(&record, 0, number_of(4, 0));
    iso_site_index_set_record(site, &record);
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_true(iso_site_is_provisional(iso_site_index_state(site)));
    assert_int_equal(iso_site_index_state(site).summary.people, 0);
    expect_person(site, metric, NULL, 1);
    for (int p = 4; p < 7; p++) {
        add_person(site, metric, p);
    }
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_false(iso_site_is_provisional(iso_site_index_state(site)));
    assert_int_equal(iso_site_index_state(site).summary.people, 3);
    iso_site_index_free(site);
}

static void it_keeps_the_shipped_metric_if_it_shall_not_adapt(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, false);
    for (int p = 0; p < PEOPLE; p++) {
        add_person(site, metric, p);
    }
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_false(iso_site_index_follow(site));
    const struct iso_site_state after = iso_site_index_state(site);
    assert_false(after.adapts || after.adapted || after.due || iso_site_is_provisional(after));
    assert_int_equal(after.summary.people, 0);
    struct iso_site_estimate none;
    assert_false(iso_site_index_estimate(site, &none));
    assert_null(iso_site_index_metric(site));
    expect_person(site, metric, NULL, 4);
    iso_site_index_remove(site, 4);
    assert_int_equal(iso_index_size(iso_site_index_current(site)), PEOPLE - 1);
    iso_site_index_free(site);
}

static void too_many_templates_change_nothing(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_index(metric, true);
    for (int p = 0; p < 3; p++) {
        for (int i = 0; i < ISO_INDEX_TEMPLATES_MAX; i++) {
            add_template(site, metric, p, i);
        }
    }
    assert_int_equal(iso_site_index_settle(site), 0);
    const struct iso_metric_vector more = vector_of(metric, 1, 99);
    assert_int_equal(iso_site_index_reserve(site, 1), 0);
    assert_int_equal(iso_site_index_add(site, 1, number_of(1, 99), &more), -EINVAL);
    assert_false(iso_site_index_state(site).due);
    assert_false(iso_site_index_follow(site));
    iso_site_index_free(site);
    iso_site_index_free(NULL);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(two_people_do_not_adapt_it),
        TEST(it_adapts_to_the_present_people),
        TEST(the_order_does_not_matter),
        TEST(a_change_is_there_at_once),
        TEST(it_estimates_with_the_metric_in_use),
        TEST(excluded_templates_do_not_teach),
        TEST(all_can_be_excluded),
        TEST(it_follows_many_changes),
        TEST(it_keeps_the_shipped_metric_if_it_shall_not_adapt),
        TEST(too_many_templates_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
