/* Site statistics: they do not depend on the order of people, a removed person leaves nothing, the
 * adapted metric is what the formula says, and one person can do only so much. */
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
    struct iso_site *site;
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
    assert_int_equal(iso_site_new(f->metric, &f->site), 0);
    for (int p = 0; p < PEOPLE; p++) {
        set_up_person(&f->people[p], p);
    }
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    iso_site_free(f->site);
    iso_metric_free(f->metric);
    free(f);
    return 0;
}

static void add(struct fixture *f, const struct person *person)
{
    assert_int_equal(iso_site_add(f->site, person->captures, person->n), 0);
}

static struct iso_metric *adapted(const struct fixture *f)
{
    struct iso_site_metric site;
    assert_int_equal(iso_site_adapt(f->site, f->metric, &site), 0);
    struct iso_metric *out = site.metric;
    site.metric = NULL;
    iso_site_metric_free(&site);
    return out;
}

static void assert_same_metric(const struct iso_metric *a, const struct iso_metric *b)
{
    const size_t values = (size_t)a->n_values;
    assert_memory_equal(a->between, b->between, DIMENSIONS * sizeof(float));
    assert_memory_equal(a->centre, b->centre, DIMENSIONS * sizeof(float));
    assert_memory_equal(a->axis, b->axis, values * DIMENSIONS * sizeof(float));
}

/* A person with one capture of the same number in every dimension but for `d`, which has `x`. */
static struct person single(int d, float x)
{
    struct person person = {.n = 1};
    person.captures[0].n = 1;
    person.captures[0].mean[d] = x;
    return person;
}

static void nobody_changes_nothing(void **state)
{
    struct fixture *f = *state;
    struct iso_metric *m = adapted(f);
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
    iso_metric_free(m);
}

static void the_order_of_people_does_not_matter(void **state)
{
    struct fixture *f = *state;
    for (int p = 0; p < PEOPLE; p++) {
        add(f, &f->people[p]);
    }
    struct iso_metric *first = adapted(f);
    iso_site_free(f->site);
    assert_int_equal(iso_site_new(f->metric, &f->site), 0);
    for (int p = PEOPLE - 1; p >= 0; p--) {
        add(f, &f->people[p]);
    }
    struct iso_metric *second = adapted(f);
    assert_same_metric(first, second);
    iso_metric_free(first);
    iso_metric_free(second);
}

static void a_removed_person_leaves_nothing(void **state)
{
    struct fixture *f = *state;
    add(f, &f->people[0]);
    add(f, &f->people[1]);
    struct iso_metric *before = adapted(f);
    const struct iso_site_summary first = iso_site_summary(f->site);
    add(f, &f->people[2]);
    struct iso_metric *between = adapted(f);
    assert_memory_not_equal(between->between, before->between, DIMENSIONS * sizeof(float));
    assert_int_equal(iso_site_remove(f->site, f->people[2].captures, f->people[2].n), 0);
    struct iso_metric *after = adapted(f);
    const struct iso_site_summary last = iso_site_summary(f->site);
    assert_same_metric(before, after);
    assert_memory_equal(&first, &last, sizeof first);
    iso_metric_free(before);
    iso_metric_free(between);
    iso_metric_free(after);
}

/* The offset is one more direction of variance within a person: with o along an axis, the variance
 * between people along it is divided by 1 + |o|^2, and the other axes keep theirs. */
static void the_common_offset_counts_for_less(void **state)
{
    struct fixture *f = *state;
    const struct person person = single(0, 3.0f);
    for (int p = 0; p < 8; p++) {
        add(f, &person);
    }
    struct iso_metric *m = adapted(f);
    const double o = 3.0 * 8 / 9;
    assert_near((double)m->between[0], 4.0, 1e-4);
    assert_near((double)m->between[1], 8.0 / 3, 1e-4);
    assert_near((double)m->between[2], 8.0 / (1.0 + o * o), 1e-4);
    const struct iso_site_summary s = iso_site_summary(f->site);
    assert_int_equal(s.people, 8);
    assert_int_equal(s.taught, 0);
    assert_near(s.offset, o / 3.0, 1e-3); /* in standard deviations: the root of 1 + 8 */
    assert_true(s.growth == 0.0 && s.share == 0.0);
    iso_metric_free(m);
}

/* Two captures at +-x have the variance 2 x^2 within the person. A person with two captures has
 * the weight 1. */
static void the_variance_within_people_is_learned(void **state)
{
    struct fixture *f = *state;
    struct person person = {.n = 2};
    person.captures[0].mean[1] = 2.0f;
    person.captures[1].mean[1] = -2.0f;
    for (int p = 0; p < 16; p++) {
        add(f, &person);
    }
    const struct iso_site_summary s = iso_site_summary(f->site);
    assert_int_equal(s.taught, 16);
    assert_near(s.share, 0.25, 1e-9);
    assert_near(s.growth, 8.0 / DIMENSIONS, 1e-6);
    struct iso_metric *m = adapted(f);
    assert_near((double)m->between[0], 8.0 / 0.75, 1e-4);
    assert_near((double)m->between[1], 8.0 / 3 / 0.75, 1e-4);
    assert_near((double)m->between[2], 4.0 / (0.75 + 0.25 * 8.0), 1e-4);
    iso_metric_free(m);
}

/* Somebody enrols captures that are as unlike people as numbers can be. */
static void one_person_can_do_only_so_much(void **state)
{
    struct fixture *f = *state;
    for (int p = 0; p < PEOPLE; p++) {
        add(f, &f->people[p]);
    }
    const struct iso_site_summary before = iso_site_summary(f->site);
    struct person attacker = {.n = ISO_SITE_CAPTURES};
    for (int i = 0; i < attacker.n; i++) {
        for (int d = 0; d < DIMENSIONS; d++) {
            attacker.captures[i].mean[d] = (i % 2 ? 1e6f : -9e5f) * (float)(d + 1);
        }
    }
    add(f, &attacker);
    const struct iso_site_summary after = iso_site_summary(f->site);
    assert_true(after.offset <=
                (before.offset * (PEOPLE + 1) + sqrt(6.0 * DIMENSIONS)) / (PEOPLE + 2) + 1e-3);
    /* Of the weights 5 + 4 + 3 + 2 + 1 of the others and 16 of the attacker. A residual has at most
     * 8 times the expected square, and n of them make n / (n - 1) of that. */
    assert_true(after.growth <= (15.0 * before.growth + 16.0 * 8.0 * 64 / 63) / 31.0 + 1e-3);
    assert_true(after.growth > before.growth);
    assert_int_equal(iso_site_remove(f->site, attacker.captures, attacker.n), 0);
    const struct iso_site_summary last = iso_site_summary(f->site);
    assert_memory_equal(&before, &last, sizeof before);
}

static void captures_beyond_the_limit_are_not_used(void **state)
{
    struct fixture *f = *state;
    struct person person = {.n = ISO_SITE_CAPTURES};
    for (int i = 0; i <= ISO_SITE_CAPTURES; i++) {
        person.captures[i].mean[0] = noise(i);
    }
    add(f, &person);
    const struct iso_site_summary exact = iso_site_summary(f->site);
    assert_int_equal(iso_site_remove(f->site, person.captures, person.n), 0);
    person.n++;
    add(f, &person);
    const struct iso_site_summary longer = iso_site_summary(f->site);
    assert_memory_equal(&exact, &longer, sizeof exact);
}

/* The vector of a template is the same whether the template or its vector is turned. */
static void a_vector_can_be_turned(void **state)
{
    struct fixture *f = *state;
    struct iso_site_metric site;
    struct iso_metric_vector shipped, direct, turned;
    struct iso_template tmpl = small_template(f->metric, 0.3);
    for (int p = 0; p < PEOPLE; p++) {
        add(f, &f->people[p]);
    }
    for (int i = 0; i < POINTS; i++) {
        tmpl.points_mm[1][4][i][2] += (float)(0.2 * i);
    }
    assert_int_equal(iso_site_adapt(f->site, f->metric, &site), 0);
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

static void wrong_arguments_are_refused(void **state)
{
    struct fixture *f = *state;
    struct iso_metric *other = small_metric();
    struct iso_site_metric out = {.n = 1};
    struct person person = f->people[0];
    assert_int_equal(iso_site_remove(f->site, person.captures, person.n), -EINVAL);
    assert_int_equal(iso_site_add(f->site, person.captures, 0), -EINVAL);
    person.captures[1].mean[2] = NAN;
    assert_int_equal(iso_site_add(f->site, person.captures, person.n), -EINVAL);
    assert_int_equal(iso_site_summary(f->site).people, 0);
    other->between[0] = 9.0f;
    assert_int_equal(iso_site_adapt(f->site, other, &out), -EINVAL);
    assert_null(out.metric);
    assert_null(out.turn);
    iso_metric_free(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(nobody_changes_nothing, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_order_of_people_does_not_matter, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_removed_person_leaves_nothing, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_common_offset_counts_for_less, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_variance_within_people_is_learned, set_up, tear_down),
        cmocka_unit_test_setup_teardown(one_person_can_do_only_so_much, set_up, tear_down),
        cmocka_unit_test_setup_teardown(captures_beyond_the_limit_are_not_used, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_vector_can_be_turned, set_up, tear_down),
        cmocka_unit_test_setup_teardown(wrong_arguments_are_refused, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
