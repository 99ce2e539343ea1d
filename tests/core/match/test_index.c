/* The index. Its scan finds the same people as the exhaustive score after any additions, changes
 * and removals. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isotherm/index.h"
#include "tests/support/memory/scarce_memory.h"

enum { DIMENSIONS = 150, PEOPLE = 3000, SHORTLIST = 10 };

/* Rounding may exchange two people whose scores differ by less than this. */
static const double rounding = 1e-4;

/* Numbers of mean 0 and variance 1, the same ones in every run. (They are sums of twelve uniform
 * numbers.) */
static float normal(uint32_t *state)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        *state = *state * 1664525u + 1013904223u;
        sum += (double)*state / 4294967296.0;
    }
    return (float)sum;
}

/* The variances between people resemble those of the shipped metric, from large to almost 0. */
static struct iso_metric *new_metric(int n_dimensions)
{
    const struct iso_metric shape = {
        .landmarks = 1,
        .n_radii = 1,
        .n_points = 4,
        .n_dimensions = n_dimensions,
        .weight_min = 0.5f,
        .gain = 0.0437f,
        .bias = 4.2f,
    };
    struct iso_metric *m = NULL;
    assert_int_equal(iso_metric_new(&shape, &m), 0);
    for (int d = 0; d < n_dimensions; d++) {
        m->between[d] = 120.0f * expf(-0.04f * (float)d);
    }
    return m;
}

/* Draws the numbers of a person. */
static struct iso_metric_vector person_of(const struct iso_metric *m, uint32_t *state)
{
    struct iso_metric_vector v = {.n = 1, .weight = 1.0f, .scale = 1.0f};
    for (int d = 0; d < m->n_dimensions; d++) {
        v.mean[d] = sqrtf(m->between[d]) * normal(state);
    }
    return v;
}

/* Draws a template of a person: the numbers of the person with noise of deviation `spread`. */
static struct iso_metric_vector template_of(const struct iso_metric *m,
                                            const struct iso_metric_vector *person, float spread,
                                            uint32_t *state)
{
    struct iso_metric_vector noisy = *person, out = {.n = 0};
    for (int d = 0; d < m->n_dimensions; d++) {
        noisy.mean[d] += spread * normal(state);
    }
    /* The weight of each template is 2^-3.5 to 2^3.5 times that of an average one. */
    noisy.weight = exp2f((float)(int)(*state >> 16 & 7) - 3.5f);
    iso_metric_vector_add(m, &noisy, &out); /* it scales the vector */
    return out;
}

struct crowd {
    struct iso_metric *metric;
    struct iso_index *index;
    uint32_t state;
    struct iso_metric_vector own[PEOPLE], all[PEOPLE]; /* person i has number 5 + 2 i */
};

static int64_t number_of(int i)
{
    return 5 + 2 * (int64_t)i;
}

/* Each person has 1 to 16 templates. */
static void enrol(struct crowd *c, int i)
{
    c->own[i] = person_of(c->metric, &c->state);
    c->all[i].n = 0;
    for (int k = 0; k < 1 + i % ISO_INDEX_TEMPLATES_MAX; k++) {
        const struct iso_metric_vector one = template_of(c->metric, &c->own[i], 1.0f, &c->state);
        iso_metric_vector_add(c->metric, &one, &c->all[i]);
        assert_int_equal(iso_index_add(c->index, number_of(i), &one), 0);
    }
}

static struct crowd *new_crowd(int people)
{
    struct crowd *c = calloc(1, sizeof *c);
    assert_non_null(c);
    c->metric = new_metric(DIMENSIONS);
    c->state = 1;
    assert_int_equal(iso_index_new(c->metric, &c->index), 0);
    assert_int_equal(iso_index_reserve(c->index, (size_t)people), 0);
    for (int i = 0; i < people; i++) {
        enrol(c, i);
    }
    assert_int_equal(iso_index_size(c->index), people);
    return c;
}

static void free_crowd(struct crowd *c)
{
    iso_index_free(c->index);
    iso_metric_free(c->metric);
    free(c);
}

static int falling(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Compares one search with the exact scores of all people. Every hit has its exact score. A person
 * who is missing from the hits may score at most `rounding` more than a hit. */
static void expect_exhaustive(const struct crowd *c, int people,
                              const struct iso_metric_vector *probe)
{
    static double scores[PEOPLE], sorted[PEOPLE];
    struct iso_search_hit hits[SHORTLIST];
    int n = 0;
    for (int i = 0; i < people; i++) {
        scores[i] = sorted[i] = iso_metric_score(c->metric, &c->all[i], probe);
    }
    qsort(sorted, (size_t)people, sizeof *sorted, falling);
    assert_int_equal(iso_index_search(c->index, probe, hits, SHORTLIST, &n), 0);
    assert_int_equal(n, people < SHORTLIST ? people : SHORTLIST);
    for (int i = 0; i < n; i++) {
        const int64_t who = (hits[i].person - 5) / 2;
        assert_true(who >= 0 && who < people);
        assert_true(hits[i].score <= scores[who] && hits[i].score >= scores[who]);
        assert_true(isnan(hits[i].distance_mm));
        assert_true(fabs(hits[i].score - sorted[i]) < rounding);
        assert_true(i == 0 || hits[i - 1].score >= hits[i].score);
    }
}

static void a_scan_finds_whom_the_exhaustive_score_finds(void **state)
{
    (void)state;
    struct crowd *c = new_crowd(PEOPLE);
    for (int i = 0; i < PEOPLE; i += 61) {
        struct iso_metric_vector probe = template_of(c->metric, &c->own[i], 1.0f, &c->state);
        expect_exhaustive(c, PEOPLE, &probe);
        probe = template_of(c->metric, &c->own[i], 8.0f, &c->state); /* hardly recognisable */
        expect_exhaustive(c, PEOPLE, &probe);
        const struct iso_metric_vector stranger = person_of(c->metric, &c->state);
        probe = template_of(c->metric, &stranger, 1.0f, &c->state);
        expect_exhaustive(c, PEOPLE, &probe);
    }
    free_crowd(c);
}

static void people_come_and_change_and_leave(void **state)
{
    (void)state;
    enum { FEW = 40 };
    struct crowd *c = new_crowd(FEW);
    struct iso_metric_vector found;
    const struct iso_metric_vector probe = template_of(c->metric, &c->own[3], 1.0f, &c->state);
    for (int i = 0; i < FEW; i++) {
        assert_int_equal(iso_index_find(c->index, number_of(i), &found), 0);
        assert_int_equal(found.n, c->all[i].n);
        assert_int_equal(found.step, c->all[i].step);
        assert_true(found.weight <= c->all[i].weight && found.weight >= c->all[i].weight);
        assert_true(found.scale <= c->all[i].scale && found.scale >= c->all[i].scale);
        assert_memory_equal(found.mean, c->all[i].mean, DIMENSIONS * sizeof(float));
    }
    /* People in the middle, the first one and the last one are removed, and are added again in
     * another order. */
    static const int moved[] = {17, 0, 39, 3};
    for (int k = 0; k < 4; k++) {
        assert_int_equal(iso_index_remove(c->index, number_of(moved[k])), 0);
        assert_int_equal(iso_index_find(c->index, number_of(moved[k]), &found), -ENOENT);
        assert_int_equal(iso_index_remove(c->index, number_of(moved[k])), -ENOENT);
        assert_int_equal(iso_index_size(c->index), FEW - 1 - k);
    }
    for (int k = 0; k < 4; k++) {
        assert_int_equal(iso_index_put(c->index, number_of(moved[k]), &c->all[moved[k]]), 0);
    }
    expect_exhaustive(c, FEW, &probe);
    /* Replaces a person by another one, with another number of templates. */
    c->all[8] = c->all[9];
    assert_int_equal(iso_index_put(c->index, number_of(8), &c->all[9]), 0);
    assert_int_equal(iso_index_size(c->index), FEW);
    expect_exhaustive(c, FEW, &probe);
    /* More space keeps the people in the index. */
    assert_int_equal(iso_index_reserve(c->index, 10 * FEW), 0);
    expect_exhaustive(c, FEW, &probe);
    free_crowd(c);
}

static void equals_come_in_the_order_of_their_numbers(void **state)
{
    (void)state;
    struct crowd *c = new_crowd(1);
    struct iso_search_hit hits[3];
    int n = 0;
    assert_int_equal(iso_index_reserve(c->index, 3), 0);
    assert_int_equal(iso_index_put(c->index, 2, &c->all[0]), 0);
    assert_int_equal(iso_index_put(c->index, 9, &c->all[0]), 0);
    assert_int_equal(iso_index_search(c->index, &c->all[0], hits, 3, &n), 0);
    assert_int_equal(n, 3);
    assert_true(hits[0].person == 2 && hits[1].person == 5 && hits[2].person == 9);
    assert_int_equal(iso_index_search(c->index, &c->all[0], hits, 2, &n), 0);
    assert_int_equal(n, 2);
    assert_true(hits[0].person == 2 && hits[1].person == 5);
    free_crowd(c);
}

/* This includes fewer dimensions than lanes, and numbers that are no multiple of the lanes. */
static void every_number_of_dimensions_will_do(void **state)
{
    (void)state;
    for (int dimensions = 1; dimensions <= ISO_METRIC_DIMENSIONS_MAX; dimensions++) {
        struct iso_metric *m = new_metric(dimensions);
        struct iso_index *index = NULL;
        uint32_t random = 7;
        const struct iso_metric_vector own = person_of(m, &random);
        const struct iso_metric_vector person = template_of(m, &own, 1.0f, &random);
        const struct iso_metric_vector probe = template_of(m, &own, 1.0f, &random);
        struct iso_search_hit hit;
        int n = 0;
        assert_int_equal(iso_index_new(m, &index), 0);
        assert_int_equal(iso_index_reserve(index, 1), 0);
        assert_int_equal(iso_index_put(index, 1, &person), 0);
        assert_int_equal(iso_index_search(index, &probe, &hit, 1, &n), 0);
        const double wanted = iso_metric_score(m, &person, &probe);
        assert_true(hit.score <= wanted && hit.score >= wanted);
        iso_index_free(index);
        iso_metric_free(m);
    }
}

static void impossible_requests_are_refused(void **state)
{
    (void)state;
    struct crowd *c = new_crowd(2);
    struct iso_metric_vector none = {.n = 0}, many = c->all[0], found = {.n = 77};
    struct iso_search_hit hit = {.person = 77};
    int n = 77;
    many.n = ISO_INDEX_TEMPLATES_MAX + 1;
    assert_int_equal(iso_index_put(c->index, 5, &none), -EINVAL);
    assert_int_equal(iso_index_put(c->index, 5, &many), -EINVAL);
    many = c->all[0];
    many.step = ISO_METRIC_STEP_MAX + 1;
    assert_int_equal(iso_index_put(c->index, 5, &many), -EINVAL);
    many.step = ISO_METRIC_STEP_MIN - 1;
    assert_int_equal(iso_index_put(c->index, 5, &many), -EINVAL);
    assert_int_equal(iso_index_add(c->index, 5, &none), -EINVAL);
    assert_int_equal(iso_index_reserve(c->index, 16), 0);
    for (int i = 2; i < 16; i++) {
        assert_int_equal(iso_index_put(c->index, 100 + i, &c->all[0]), 0);
    }
    assert_int_equal(iso_index_put(c->index, 99, &c->all[0]), -ENOSPC);
    assert_int_equal(iso_index_add(c->index, 99, &c->all[0]), -ENOSPC);
    assert_int_equal(iso_index_put(c->index, 5, &c->all[1]),
                     0); /* a known person needs no more space */
    assert_int_equal(iso_index_size(c->index), 16);
    assert_int_equal(iso_index_find(c->index, 6, &found), -ENOENT);
    assert_int_equal(found.n, 77);
    assert_int_equal(iso_index_search(c->index, &c->all[1], &hit, 1, &n),
                     -EINVAL); /* the probe is of two templates */
    assert_int_equal(iso_index_search(c->index, &none, &hit, 1, &n), -EINVAL);
    assert_int_equal(iso_index_search(c->index, &c->all[0], &hit, -1, &n), -EINVAL);
    assert_int_equal(iso_index_search(c->index, &c->all[0], &hit, ISO_INDEX_HITS_MAX + 1, &n),
                     -EINVAL);
    assert_true(n == 77 && hit.person == 77);
    assert_int_equal(iso_index_search(c->index, &c->all[0], NULL, 0, &n), 0);
    assert_int_equal(n, 0);
    free_crowd(c);
    iso_index_free(NULL);
}

static void an_empty_index_finds_nobody(void **state)
{
    (void)state;
    struct crowd *c = new_crowd(0);
    const struct iso_metric_vector own = person_of(c->metric, &c->state);
    struct iso_search_hit hit;
    int n = 77;
    assert_int_equal(iso_index_search(c->index, &own, &hit, 1, &n), 0);
    assert_int_equal(n, 0);
    assert_int_equal(iso_index_put(c->index, 1, &own), -ENOSPC);
    free_crowd(c);
}

static int grow(void *context, struct iso_fault *fault)
{
    struct crowd *c = context;
    struct iso_index *index = NULL;
    int error = iso_index_new(c->metric, &index);
    if (!error) {
        error = iso_index_reserve(index, 16);
    }
    if (!error) {
        assert_int_equal(iso_index_put(index, 1, &c->all[0]), 0);
        error = iso_index_reserve(index, 17);
        assert_int_equal(iso_index_size(index), 1);
        assert_int_equal(iso_index_find(index, 1, &c->all[1]), 0);
    }
    iso_index_free(index);
    return error ? iso_fault_set(fault, error, "out of memory") : 0;
}

static void nothing_leaks_when_memory_runs_out(void **state)
{
    (void)state;
    struct crowd *c = new_crowd(1);
    assert_int_equal(scarce_memory_exhaust(grow, c, 12), 9);
    free_crowd(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scan_finds_whom_the_exhaustive_score_finds),
        cmocka_unit_test(people_come_and_change_and_leave),
        cmocka_unit_test(equals_come_in_the_order_of_their_numbers),
        cmocka_unit_test(every_number_of_dimensions_will_do),
        cmocka_unit_test(impossible_requests_are_refused),
        cmocka_unit_test(an_empty_index_finds_nobody),
        cmocka_unit_test(nothing_leaks_when_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
