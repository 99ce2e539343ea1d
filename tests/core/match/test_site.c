/* Site statistics: they do not depend on the order of people, the adapted metric is what the
 * formula says, and what one person shows alone is left out. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/match/site.h"
#include "tests/core/match/small_metric.h"
#include "tests/support/near.h"

enum { CAPTURES = 6, PEOPLE = 5 };

struct person {
    int n;
    struct iso_metric_vector captures[ISO_SITE_CAPTURES + 1];
};

struct fixture {
    struct iso_metric *metric;
    struct person people[PEOPLE];
};

/* A number in -1..1 that looks random. */
static float noise(int seed)
{
    return (float)sin(12.9898 * seed + 1.0);
}

static void set_up_person(struct person *person, int number)
{
    person->n = CAPTURES - number;
    for (int i = 0; i < person->n; i++) {
        for (int d = 0; d < DIMENSIONS; d++) {
            const int seed = 100 * number + 10 * i + d;
            person->captures[i].n = 1;
            person->captures[i].mean[d] = 2.0f * noise(7 * number + d) + noise(seed);
        }
    }
}

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->metric = small_metric();
    for (int p = 0; p < PEOPLE; p++) {
        set_up_person(&f->people[p], p);
    }
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    iso_metric_free(f->metric);
    free(f);
    return 0;
}

/* Shows n people to statistics in both passes. The number of a person is 10 times the place in
 * `people`, from `first` on in steps of `step`. */
static struct iso_site *statistics_of(const struct iso_metric *metric, const struct person *people,
                                      int n, int first, int step)
{
    struct iso_site *site = NULL;
    assert_int_equal(iso_site_new(metric, &site), 0);
    for (int i = 0, p = first; i < n; i++, p += step) {
        assert_int_equal(iso_site_add(site, 10 * p, people[p].captures, people[p].n), 0);
    }
    assert_int_equal(iso_site_find_directions(site), 0);
    for (int i = 0, p = first; i < n; i++, p += step) {
        assert_int_equal(iso_site_review(site, people[p].captures, people[p].n), 0);
    }
    return site;
}

static struct iso_site_metric adapted_to(const struct iso_metric *metric,
                                         const struct person *people, int n)
{
    struct iso_site_metric adapted;
    struct iso_site *site = statistics_of(metric, people, n, 0, 1);
    assert_int_equal(iso_site_adapt(site, metric, &adapted), 0);
    iso_site_free(site);
    return adapted;
}

static struct iso_site_summary summary_of(const struct iso_metric *metric,
                                          const struct person *people, int n)
{
    struct iso_site *site = statistics_of(metric, people, n, 0, 1);
    const struct iso_site_summary summary = iso_site_summary(site);
    iso_site_free(site);
    return summary;
}

/* Sets n captures, alternately at +x and -x in dimension d, and 0 elsewhere. */
static void spread_along(struct person *person, int n, int d, float x)
{
    *person = (struct person){.n = n};
    for (int i = 0; i < n; i++) {
        person->captures[i].n = 1;
        person->captures[i].mean[d] = i % 2 ? -x : x;
    }
}

static void nobody_changes_nothing(void **state)
{
    struct fixture *f = *state;
    struct iso_site_metric site = adapted_to(f->metric, f->people, 0);
    const struct iso_metric *m = site.metric;
    assert_int_equal(m->algorithm, f->metric->algorithm);
    assert_true(m->gain == f->metric->gain && m->bias == f->metric->bias);
    assert_memory_equal(m->curve_mm, f->metric->curve_mm, (size_t)m->n_values * sizeof(float));
    for (int d = 0; d < DIMENSIONS; d++) {
        assert_near((double)m->between[d], f->metric->between[d], 1e-5);
        assert_near(fabs((double)m->centre[d]), fabs((double)f->metric->centre[d]), 1e-6);
    }
    for (int i = 0; i < m->n_values * DIMENSIONS; i++) {
        assert_near(fabs((double)m->axis[i]), fabs((double)f->metric->axis[i]), 1e-5);
    }
    assert_int_equal(site.n_own, 0);
    iso_site_metric_free(&site);
}

static void the_order_of_people_does_not_matter(void **state)
{
    struct fixture *f = *state;
    struct iso_site *there = statistics_of(f->metric, f->people, PEOPLE, 0, 1);
    struct iso_site *back = statistics_of(f->metric, f->people, PEOPLE, PEOPLE - 1, -1);
    struct iso_site_metric a, b;
    const struct iso_site_summary first = iso_site_summary(there), last = iso_site_summary(back);
    assert_memory_equal(&first, &last, sizeof first);
    assert_int_equal(iso_site_adapt(there, f->metric, &a), 0);
    assert_int_equal(iso_site_adapt(back, f->metric, &b), 0);
    const size_t values = (size_t)a.metric->n_values;
    assert_memory_equal(a.metric->between, b.metric->between, DIMENSIONS * sizeof(float));
    assert_memory_equal(a.metric->centre, b.metric->centre, DIMENSIONS * sizeof(float));
    assert_memory_equal(a.metric->axis, b.metric->axis, values * DIMENSIONS * sizeof(float));
    assert_memory_equal(a.offset, b.offset, DIMENSIONS * sizeof(float));
    assert_int_equal(a.n_own, PEOPLE);
    assert_memory_equal(a.number, b.number, PEOPLE * sizeof *a.number);
    assert_memory_equal(a.own, b.own, (size_t)PEOPLE * DIMENSIONS * sizeof *a.own);
    iso_site_metric_free(&a);
    iso_site_metric_free(&b);
    iso_site_free(there);
    iso_site_free(back);
}

/* The offset is one more direction of variance within a person: with o along an axis, the variance
 * between people along it is divided by 1 + |o|^2, and the other axes keep theirs. */
static void the_common_offset_counts_for_less(void **state)
{
    struct fixture *f = *state;
    static struct person people[8];
    for (int p = 0; p < 8; p++) {
        spread_along(&people[p], 1, 0, 3.0f);
    }
    struct iso_site_metric site = adapted_to(f->metric, people, 8);
    const double o = 3.0 * 8 / 9;
    assert_near((double)site.metric->between[0], 4.0, 1e-4);
    assert_near((double)site.metric->between[1], 8.0 / 3, 1e-4);
    assert_near((double)site.metric->between[2], 8.0 / (1.0 + o * o), 1e-4);
    const struct iso_site_summary s = summary_of(f->metric, people, 8);
    assert_int_equal(s.people, 8);
    assert_int_equal(s.taught, 0);
    assert_near(s.offset, o / 3.0, 1e-3); /* in standard deviations: the root of 1 + 8 */
    assert_true(s.growth == 0.0 && s.share == 0.0);
    iso_site_metric_free(&site);
}

/* Two captures at +-x have the variance 2 x^2 within the person. A person with two captures has
 * the weight 1. Directions are known by half with a weight of 50: the variances above their mean
 * shrink towards it, and no variance is below it. */
static void the_variance_within_people_is_learned(void **state)
{
    struct fixture *f = *state;
    static struct person people[16];
    for (int p = 0; p < 16; p++) {
        spread_along(&people[p], 2, 1, 1.5f);
    }
    const struct iso_site_summary s = summary_of(f->metric, people, 16);
    assert_int_equal(s.taught, 16);
    assert_near(s.share, 0.25, 1e-9);
    struct iso_site_metric site = adapted_to(f->metric, people, 16);
    const double known = 16.0 / (16.0 + 50.0), mean = 4.5 / DIMENSIONS;
    const double others = 0.75 + 0.25 * mean;
    const double along = 0.75 + 0.25 * (known * 4.5 + (1.0 - known) * mean);
    assert_near(s.growth, mean + known * (4.5 - mean) / DIMENSIONS, 1e-6);
    assert_near((double)site.metric->between[0], 8.0 / others, 1e-4);
    assert_near((double)site.metric->between[1], 4.0 / along, 1e-4);
    assert_near((double)site.metric->between[2], 8.0 / 3 / others, 1e-4);
    iso_site_metric_free(&site);
}

/* The variance along a direction is limited to 6, and so is the mean of all directions. */
static void no_variance_is_boundless(void **state)
{
    struct fixture *f = *state;
    static struct person people[16];
    for (int p = 0; p < 16; p++) {
        spread_along(&people[p], 2, 1, 3.25f);
    }
    assert_near(summary_of(f->metric, people, 16).growth, 6.0, 1e-6);
}

/* Nine people vary along axis 1 and have nothing in common. The tenth person enrols captures with
 * huge numbers, which no face gives. The offset moves by only two elevenths of a standard
 * deviation, and the variance along axis 2 does not rise. */
static void what_one_person_shows_alone_is_left_out(void **state)
{
    struct fixture *f = *state;
    static struct person people[10];
    for (int p = 0; p < 9; p++) {
        spread_along(&people[p], 2, 1, 1.0f);
    }
    spread_along(&people[9], ISO_SITE_CAPTURES, 2, 1e6f);
    for (int i = 0; i < ISO_SITE_CAPTURES; i++) {
        people[9].captures[i].mean[0] = 1e6f;
    }
    const struct iso_site_summary s = summary_of(f->metric, people, 10);
    assert_near(s.offset, 2.0 / 11, 1e-6);
    /* Along axis 1 alone, without one of the nine; the mean is without the tenth. Their weight is
     * 9 + 4. */
    const double known = 13.0 / (13.0 + 50.0), mean = 2.0 / DIMENSIONS, along = 16.0 / 9.0;
    assert_near(s.growth, mean + known * (along - mean) / DIMENSIONS, 1e-6);
}

static void captures_beyond_the_limit_are_not_used(void **state)
{
    struct fixture *f = *state;
    static struct person people[2];
    for (int p = 0; p < 2; p++) {
        people[p].n = ISO_SITE_CAPTURES + p;
        for (int i = 0; i < people[p].n; i++) {
            people[p].captures[i].mean[0] = noise(i);
        }
    }
    const struct iso_site_summary exact = summary_of(f->metric, &people[0], 1);
    const struct iso_site_summary longer = summary_of(f->metric, &people[1], 1);
    assert_memory_equal(&exact, &longer, sizeof exact);
}

/* The vector of a template is the same whether the template or its vector is turned. */
static void a_vector_can_be_turned(void **state)
{
    struct fixture *f = *state;
    struct iso_site_metric site = adapted_to(f->metric, f->people, PEOPLE);
    struct iso_metric_vector shipped, direct, turned;
    struct iso_template tmpl = small_template(f->metric, 0.3);
    for (int i = 0; i < POINTS; i++) {
        tmpl.points_mm[1][4][i][2] += (float)(0.2 * i);
    }
    assert_int_equal(iso_metric_project(f->metric, &tmpl, &shipped), 0);
    assert_int_equal(iso_metric_project(site.metric, &tmpl, &direct), 0);
    iso_site_turn(&site, &shipped, &turned);
    for (int d = 0; d < DIMENSIONS; d++) {
        assert_near((double)turned.mean[d], direct.mean[d], 1e-4);
    }
    assert_int_equal(turned.n, 1);
    assert_int_equal(turned.step, direct.step);
    assert_near((double)turned.weight, direct.weight, 1e-6);
    assert_near((double)turned.scale, direct.scale, 1e-4);
    assert_true(fabsf(turned.mean[0] - shipped.mean[0]) > 0.01f);
    iso_site_metric_free(&site);
}

/* Calls in the wrong pass are refused, and so is a person who is in one pass alone. */
static void wrong_arguments_are_refused(void **state)
{
    struct fixture *f = *state;
    struct iso_metric *other = small_metric();
    struct iso_site_metric out = {.n = 1};
    struct iso_site *site = NULL;
    struct person person = f->people[0];
    assert_int_equal(iso_site_new(f->metric, &site), 0);
    assert_int_equal(iso_site_add(site, 1, person.captures, 0), -EINVAL);
    assert_int_equal(iso_site_review(site, person.captures, person.n), -EINVAL);
    person.captures[1].mean[2] = NAN;
    assert_int_equal(iso_site_add(site, 1, person.captures, person.n), -EINVAL);
    assert_int_equal(iso_site_summary(site).people, 0);
    person = f->people[0];
    assert_int_equal(iso_site_add(site, 1, person.captures, person.n), 0);
    assert_int_equal(iso_site_find_directions(site), 0);
    assert_int_equal(iso_site_find_directions(site), -EINVAL);
    assert_int_equal(iso_site_add(site, 2, person.captures, person.n), -EINVAL);
    assert_int_equal(iso_site_adapt(site, f->metric, &out), -EINVAL);
    assert_int_equal(iso_site_review(site, person.captures, person.n), 0);
    assert_int_equal(iso_site_review(site, person.captures, person.n), -EINVAL);
    other->between[0] = 9.0f;
    assert_int_equal(iso_site_adapt(site, other, &out), -EINVAL);
    assert_null(out.metric);
    assert_null(out.turn);
    iso_site_free(site);
    iso_metric_free(other);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(nobody_changes_nothing),
        TEST(the_order_of_people_does_not_matter),
        TEST(the_common_offset_counts_for_less),
        TEST(the_variance_within_people_is_learned),
        TEST(no_variance_is_boundless),
        TEST(what_one_person_shows_alone_is_left_out),
        TEST(captures_beyond_the_limit_are_not_used),
        TEST(a_vector_can_be_turned),
        TEST(wrong_arguments_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
