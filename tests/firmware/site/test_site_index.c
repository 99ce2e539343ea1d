/* The index of people by a metric that adapts to them: it is what core/match/site.h computes from
 * the present people, whatever happened before; and it has every change at once. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/match/metric_vector.h"
#include "firmware/site/site_index.h"
#include "tests/firmware/site/site_rig.h"

/* Shows the people who are here to the statistics, in the first pass or in the second one. */
static void pass_people(struct iso_site *statistics, const struct iso_metric *metric,
                        const bool *is_here, bool second)
{
    struct iso_metric_vector captures[TEMPLATES];
    for (int p = 0; p < PEOPLE; p++) {
        for (int i = 0; i < TEMPLATES; i++) {
            captures[i] = site_rig_vector_of(metric, p, i);
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

/* Expects the person's vector by this metric. */
static void expect_person(const struct iso_site_index *site, const struct iso_metric *metric,
                          const struct iso_site_metric *adapted, int64_t person)
{
    struct iso_metric_vector all = {.n = 0}, found, one;
    for (int i = 0; i < TEMPLATES; i++) {
        one = site_rig_vector_of(metric, person, i);
        if (adapted) {
            const struct iso_metric_vector shipped = one;
            iso_site_turn(adapted, &shipped, &one);
        }
        iso_metric_vector_add(adapted ? adapted->metric : metric, &one, &all);
    }
    assert_int_equal(iso_site_index_person(site, person, &found), 0);
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
            assert_int_equal(iso_site_index_person(site, p, &none), -ENOENT);
            assert_int_equal(iso_index_find(iso_site_index_current(site), p, &none), -ENOENT);
        }
    }
    iso_site_metric_free(&adapted);
}

static void two_people_do_not_adapt_it(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true);
    site_rig_add_person(site, metric, 0);
    site_rig_add_person(site, metric, 1);
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
    struct iso_site_index *site = site_rig_new_index(metric, true);
    bool is_here[PEOPLE] = {false};
    for (int p = 0; p < PEOPLE; p++) {
        site_rig_add_person(site, metric, p);
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
    struct iso_site_index *site = site_rig_new_index(metric, true);
    bool is_here[PEOPLE];
    for (int i = 0; i < TEMPLATES; i++) {
        for (int p = PEOPLE - 1; p >= 0; p--) {
            site_rig_add_template(site, metric, p, i);
            is_here[p] = true;
        }
    }
    expect_adapted(site, metric, is_here);
    iso_site_index_free(site);
}

static void a_change_is_there_at_once(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true);
    struct iso_metric_vector found;
    bool is_here[PEOPLE] = {true, true, true, false};
    for (int p = 0; p < 3; p++) {
        site_rig_add_person(site, metric, p);
    }
    expect_adapted(site, metric, is_here);
    const struct iso_site_metric *before = iso_site_index_metric(site);
    const struct iso_metric *metric_before = before->metric;
    site_rig_add_person(site, metric, 3);
    iso_site_index_remove(site, 1);
    assert_ptr_equal(iso_site_index_metric(site)->metric, metric_before);
    expect_person(site, metric, before, 3);
    assert_int_equal(iso_index_find(iso_site_index_current(site), 1, &found), -ENOENT);
    is_here[1] = false;
    is_here[3] = true;
    expect_adapted(site, metric, is_here);
    iso_site_index_free(site);
}

/* The thread is disturbed at any moment, and searches go on. */
static void it_follows_many_changes(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true);
    bool is_here[PEOPLE] = {false};
    int followed = 0;
    for (unsigned step = 0; step < 400; step++) {
        const int p = (int)(step * 2654435761U >> 16) % PEOPLE;
        const struct iso_metric_vector probe = site_rig_vector_of(metric, p, 0);
        struct iso_metric_vector found;
        struct iso_search_hit hits[PEOPLE];
        int n = 0, expected = 0;
        if (is_here[p]) {
            iso_site_index_remove(site, p);
        } else {
            site_rig_add_person(site, metric, p);
        }
        is_here[p] = !is_here[p];
        followed += iso_site_index_follow(site);
        assert_int_equal(iso_site_index_person(site, p, &found), is_here[p] ? 0 : -ENOENT);
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
            site_rig_add_person(site, metric, p);
            is_here[p] = true;
        }
    }
    expect_adapted(site, metric, is_here);
    iso_site_index_free(site);
}

static void it_keeps_the_shipped_metric_if_it_shall_not_adapt(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, false);
    for (int p = 0; p < PEOPLE; p++) {
        site_rig_add_person(site, metric, p);
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

/* Adds somebody with whom no metric can be computed. */
static void add_unusable_person(struct iso_site_index *site, const struct iso_metric *metric)
{
    struct iso_metric_vector vector = site_rig_vector_of(metric, PEOPLE, 0);
    vector.mean[0] = NAN;
    assert_int_equal(iso_site_index_reserve(site, 1), 0);
    assert_int_equal(
        iso_site_index_add(site, PEOPLE, site_rig_number_of(PEOPLE, 0), SITE_RIG_SENSOR, &vector),
        0);
    assert_int_equal(iso_site_index_settle(site), -EINVAL);
}

/* If the metric cannot be computed anew after a removal, none is used that knows who was removed.
 */
static void a_failed_computation_keeps_no_removed_person(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true);
    bool is_here[PEOPLE] = {true, true, true, true, false};
    for (int p = 0; p < 4; p++) {
        site_rig_add_person(site, metric, p);
    }
    expect_adapted(site, metric, is_here);
    add_unusable_person(site, metric);
    assert_non_null(iso_site_index_metric(site)); /* nobody was removed */
    iso_site_index_remove(site, 1);
    assert_int_equal(iso_site_index_settle(site), -EINVAL);
    assert_null(iso_site_index_metric(site));
    const struct iso_site_state after = iso_site_index_state(site);
    assert_true(iso_site_is_provisional(after) && after.error == -EINVAL && !after.due);
    expect_person(site, metric, NULL, 0);
    expect_person(site, metric, NULL, 3);
    iso_site_index_remove(site, PEOPLE);
    is_here[1] = false;
    expect_adapted(site, metric, is_here);
    /* The same if templates teach no more. */
    add_unusable_person(site, metric);
    assert_non_null(iso_site_index_metric(site));
    iso_site_index_set_record(site, &(struct iso_site_record){0});
    assert_int_equal(iso_site_index_settle(site), -EINVAL);
    assert_null(iso_site_index_metric(site));
    iso_site_index_free(site);
}

static void too_many_templates_change_nothing(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true);
    for (int p = 0; p < 3; p++) {
        for (int i = 0; i < ISO_INDEX_TEMPLATES_MAX; i++) {
            site_rig_add_template(site, metric, p, i);
        }
    }
    assert_int_equal(iso_site_index_settle(site), 0);
    const struct iso_metric_vector more = site_rig_vector_of(metric, 1, 99);
    assert_int_equal(iso_site_index_reserve(site, 1), 0);
    assert_int_equal(iso_site_index_add(site, 1, site_rig_number_of(1, 99), SITE_RIG_SENSOR, &more),
                     -EINVAL);
    assert_false(iso_site_index_state(site).due);
    assert_false(iso_site_index_follow(site));
    iso_site_index_free(site);
    iso_site_index_free(NULL);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, site_rig_set_up, site_rig_tear_down)
    const struct CMUnitTest tests[] = {
        TEST(two_people_do_not_adapt_it),
        TEST(it_adapts_to_the_present_people),
        TEST(the_order_does_not_matter),
        TEST(a_change_is_there_at_once),
        TEST(it_follows_many_changes),
        TEST(it_keeps_the_shipped_metric_if_it_shall_not_adapt),
        TEST(a_failed_computation_keeps_no_removed_person),
        TEST(too_many_templates_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
