/* The codes of an index: their filters agree with the plain one, and a search by codes finds the
 * same people, with the same scores, as one that scores everybody. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/match/index/index_inside.h"

enum { DIMENSIONS = 90, PEOPLE = 4000, SHORTLIST = 10, FAMILY = 25 };

static uint32_t next(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* Of mean 0 and variance 1. */
static float normal(uint32_t *state)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        sum += (double)next(state) / 16777216.0;
    }
    return (float)sum;
}

static void filters_agree(void **context)
{
    (void)context;
    uint32_t state = 3;
    static int8_t codes[ISO_CODE_NUMBERS_MAX * ISO_CODE_LANES];
    iso_code_filter *const here = iso_code_filter_here();
    int n_passed = 0, n_all = 0;
    if (!here) {
        skip();
    }
    for (int round = 0; round < 500; round++) {
        const int n_pairs = 1 + round % ISO_CODE_PAIRS_MAX;
        const int most = 120 * 120 / (2 * n_pairs);
        struct iso_code_probe probe;
        for (int d = 0; d < 2 * n_pairs; d++) {
            probe.weight[d] = (int16_t)(next(&state) % (uint32_t)(fmin(sqrt(most), 85.0) + 1.0));
            probe.centre[d] = (int16_t)(probe.weight[d] * ((int)(next(&state) % 513u) - 256));
        }
        for (size_t i = 0; i < sizeof codes; i++) {
            codes[i] = (int8_t)((int)(next(&state) & 255u) - 128);
        }
        for (int k = 0; k < 40; k++) {
            const int32_t limit = (int32_t)((int64_t)(next(&state) << 7) * (k % 4) / 3);
            const uint32_t plain = iso__code_filter_plain(codes, &probe, n_pairs, limit);
            assert_int_equal(here(codes, &probe, n_pairs, limit), plain);
            n_passed += __builtin_popcount(plain);
            n_all += ISO_CODE_LANES;
        }
    }
    assert_in_range(n_passed, n_all / 10, n_all * 9 / 10);
}

/* The variances between people fall from number to number by this factor. */
static struct iso_metric *new_metric(int n_dimensions, float fall)
{
    const struct iso_metric shape = {
        .landmarks = 1,
        .n_radii = 1,
        .n_points = 4,
        .n_dimensions = n_dimensions,
        .weight_min = 0.5f,
        .gain = 0.3f,
        .bias = 1.2f,
    };
    struct iso_metric *m = NULL;
    assert_int_equal(iso_metric_new(&shape, &m), 0);
    for (int d = 0; d < n_dimensions; d++) { /* the last numbers are of no use */
        m->between[d] = d < n_dimensions - 4 ? 67.0f * powf(fall, (float)d) : 0.0f;
    }
    return m;
}

/* Some people are so far from all others that their codes are limited. */
static struct iso_metric_vector vector_of(const struct iso_metric *m, uint32_t *state)
{
    struct iso_metric_vector one = {.n = 1, .weight = 1.0f}, scaled = {.n = 0};
    const float far = next(state) % 20u == 0 ? 12.0f : 1.0f;
    for (int d = 0; d < m->n_dimensions; d++) {
        one.mean[d] = far * sqrtf(m->between[d] + 1.0f) * normal(state);
    }
    one.weight = exp2f((float)(next(state) % 4u) - 1.5f);
    iso_metric_vector_add(m, &one, &scaled);
    scaled.scale *= far; /* the metric brings vectors to their usual length */
    return scaled;
}

/* Somebody who looks much like another person. */
static struct iso_metric_vector relative_of(const struct iso_metric *m, struct iso_metric_vector v,
                                            uint32_t *state)
{
    for (int d = 0; d < m->n_dimensions; d++) {
        v.mean[d] += 0.1f * normal(state);
    }
    return v;
}

/* Searches without a filter, with the plain filter and with the filter of this machine, and expects
 * the same people and the same bits of their scores. */
static void expect_same(struct iso_index *index, const struct iso_metric_vector *probe)
{
    iso_code_filter *const filters[] = {NULL, iso__code_filter_plain, iso_code_filter_here()};
    struct iso_search_hit hits[3][SHORTLIST];
    for (int k = 0; k < 3; k++) {
        int n = 0;
        index->filter = filters[k];
        assert_int_equal(iso_index_search(index, probe, hits[k], SHORTLIST, &n), 0);
        assert_int_equal(n, SHORTLIST);
        for (int i = 0; i < n; i++) {
            assert_int_equal(hits[k][i].person, hits[0][i].person);
            assert_memory_equal(&hits[k][i].score, &hits[0][i].score, sizeof hits[0][i].score);
        }
    }
}

static void expect_same_for_many(struct iso_index *index, const struct iso_metric *m,
                                 uint32_t *state)
{
    for (int i = 0; i < 60; i++) {
        struct iso_metric_vector probe = vector_of(m, state);
        expect_same(index, &probe);
        assert_int_equal(iso_index_find(index, 3 * (int64_t)(next(state) % 1000u), &probe), 0);
        probe.n = 1;
        expect_same(index, &probe);
    }
}

/* Every row has its codes in the block that it names. */
static void expect_places(const struct iso_index *index)
{
    size_t n = 0;
    for (size_t b = 0; b < index->codes.n_blocks; b++) {
        const struct iso_code_block *block = &index->codes.block[b];
        assert_in_range(block->n, 1, ISO_CODE_LANES);
        for (int i = 0; i < block->n; i++, n++) {
            const struct iso_index_row *row = &index->row[block->row[i]];
            assert_int_equal(row->place, b * ISO_CODE_LANES + (size_t)i);
            assert_int_equal(row->step - ISO_METRIC_STEP_MIN, block->step);
        }
    }
    assert_int_equal(n, index->n);
}

static void codes_find_whom_a_full_search_finds(void **context)
{
    (void)context;
    static const struct {
        int n_dimensions;
        float fall;
    } metrics[] = {{1, 0.9f},  {7, 0.9f},          {60, 0.9f},
                   {61, 0.9f}, {DIMENSIONS, 0.9f}, {DIMENSIONS, 0.99f}};
    for (size_t s = 0; s < sizeof metrics / sizeof *metrics; s++) {
        struct iso_metric *m = new_metric(metrics[s].n_dimensions, metrics[s].fall);
        struct iso_index *index = NULL;
        uint32_t state = 5;
        assert_int_equal(iso_index_new(m, &index), 0);
        assert_int_equal(iso_index_reserve(index, PEOPLE), 0);
        struct iso_metric_vector v = {.n = 0};
        for (int i = 0; i < PEOPLE; i++) {
            v = i % FAMILY == 0 ? vector_of(m, &state) : relative_of(m, v, &state);
            assert_int_equal(iso_index_put(index, 3 * i, &v), 0);
        }
        expect_places(index);
        expect_same_for_many(index, m, &state);
        iso_index_free(index);
        iso_metric_free(m);
    }
}

/* People who leave, return with other vectors, and come in between. */
static void codes_follow_their_people(void **context)
{
    (void)context;
    struct iso_metric *m = new_metric(DIMENSIONS, 0.9f);
    struct iso_index *index = NULL;
    uint32_t state = 9;
    assert_int_equal(iso_index_new(m, &index), 0);
    for (int i = 0; i < 6000; i++) {
        const int64_t person = 3 * (int64_t)(next(&state) % 1000u);
        const struct iso_metric_vector v = vector_of(m, &state);
        assert_int_equal(iso_index_reserve(index, iso_index_size(index) + 1), 0);
        if (i % 3 == 0) {
            const int error = iso_index_remove(index, person);
            assert_true(error == 0 || error == -ENOENT);
        } else {
            assert_int_equal(iso_index_put(index, person, &v), 0);
        }
        if (i % 600 == 599) {
            expect_places(index);
        }
    }
    for (int i = 0; i < 1000; i++) {
        const struct iso_metric_vector v = vector_of(m, &state);
        assert_int_equal(iso_index_reserve(index, iso_index_size(index) + 1), 0);
        assert_int_equal(iso_index_put(index, 3 * i, &v), 0);
    }
    expect_same_for_many(index, m, &state);
    for (int i = 0; i < 1000; i++) {
        assert_int_equal(iso_index_remove(index, 3 * ((i * 7) % 1000)), 0);
        expect_places(index);
    }
    assert_int_equal(index->codes.n_blocks, 0);
    iso_index_free(index);
    iso_metric_free(m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filters_agree),
        cmocka_unit_test(codes_find_whom_a_full_search_finds),
        cmocka_unit_test(codes_follow_their_people),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
