/* The rows of a site: people and templates in order, and the rounding of vectors. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/site/site_rows.h"

enum { WIDTH = 5 };

static void insert(struct iso_site_rows *rows, int64_t person, uint64_t number, float first)
{
    struct iso_metric_vector vector = {.n = 1, .mean = {first, -0.3f, 0.0f, 0.01f, 2.0f}};
    assert_int_equal(iso_site_rows_reserve(rows, 1), 0);
    iso_site_rows_insert(rows, person, number, "astra", &vector);
}

static void rows_are_sorted_by_person(void **state)
{
    struct iso_site_rows rows = {.width = WIDTH};
    (void)state;
    for (int i = 0; i < 100; i++) {
        insert(&rows, 37 * i % 10, (uint64_t)i, (float)i);
    }
    assert_int_equal(rows.n, 100);
    for (size_t at = 1; at < rows.n; at++) {
        assert_true(
            rows.person[at - 1] < rows.person[at] ||
            (rows.person[at - 1] == rows.person[at] && rows.number[at - 1] < rows.number[at]));
    }
    assert_int_equal(iso_site_rows_find(&rows, 3), 30);
    iso_site_rows_remove(&rows, 3);
    iso_site_rows_remove(&rows, 3);
    assert_int_equal(rows.n, 90);
    assert_int_equal(rows.person[iso_site_rows_find(&rows, 3)], 4);
    assert_int_equal(iso_site_rows_find(&rows, 10), rows.n);
    iso_site_rows_free(&rows);
}

/* Each number is off by at most half a unit, and 127 units are less than twice the largest one. */
static void vectors_are_rounded_to_the_unit(void **state)
{
    static const float largest[] = {0.02f, 1.0f, 63.4f, 63.6f, 126.9f, 127.0f, 127.1f, 1e6f};
    (void)state;
    for (size_t i = 0; i < sizeof largest / sizeof *largest; i++) {
        struct iso_site_rows rows = {.width = WIDTH};
        struct iso_metric_vector vector = {.n = 1}, once, twice;
        for (int d = 0; d < WIDTH; d++) {
            vector.mean[d] = largest[i] * cosf((float)d);
        }
        assert_int_equal(iso_site_rows_reserve(&rows, 2), 0);
        iso_site_rows_insert(&rows, 1, 1, "astra", &vector);
        iso_site_rows_get(&rows, 0, &once);
        assert_int_equal(once.n, 1);
        assert_true(127.0f * rows.unit[0] >= largest[i] && 63.5f * rows.unit[0] < largest[i]);
        for (int d = 0; d < WIDTH; d++) {
            assert_true(fabsf(once.mean[d] - vector.mean[d]) <= 0.5f * rows.unit[0]);
        }
        iso_site_rows_insert(&rows, 1, 2, "astra", &once);
        iso_site_rows_get(&rows, 1, &twice);
        assert_memory_equal(twice.mean, once.mean, sizeof once.mean);
        iso_site_rows_free(&rows);
    }
}

static void a_vector_that_is_not_finite_stays_so(void **state)
{
    struct iso_site_rows rows = {.width = WIDTH};
    struct iso_metric_vector vector = {.n = 1, .mean = {0.0f, -INFINITY, 3.0f}}, got;
    (void)state;
    assert_int_equal(iso_site_rows_reserve(&rows, 2), 0);
    iso_site_rows_insert(&rows, 1, 1, "astra", &vector);
    iso_site_rows_get(&rows, 0, &got);
    for (int d = 0; d < WIDTH; d++) {
        assert_true(isnan(got.mean[d]));
    }
    memset(&vector.mean, 0, sizeof vector.mean);
    iso_site_rows_insert(&rows, 2, 2, "astra", &vector);
    iso_site_rows_get(&rows, 1, &got);
    assert_memory_equal(got.mean, vector.mean, WIDTH * sizeof(float));
    iso_site_rows_free(&rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_sorted_by_person),
        cmocka_unit_test(vectors_are_rounded_to_the_unit),
        cmocka_unit_test(a_vector_that_is_not_finite_stays_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
