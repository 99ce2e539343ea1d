/* The Gram matrix of rows, compared with a plain sum in double precision. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/gram.h"

enum { N_MAX = 103, ROWS_MAX = 1000 };

/* A fixed sequence of values in -1..1. */
static float value(uint32_t i)
{
    uint32_t x = (i + 1u) * 2654435761u;
    x ^= x >> 15;
    x *= 2246822519u;
    return (float)(x >> 8) / (float)(1u << 23) - 1.0f;
}

/* Rows of n values, which end with zeros. */
static float *new_rows(int n_rows, int n)
{
    const int stride = iso_gram_stride(n);
    const size_t bytes = (size_t)n_rows * (size_t)stride * sizeof(float);
    float *rows = aligned_alloc(ISO_GRAM_ALIGNMENT, bytes + ISO_GRAM_ALIGNMENT);
    assert_true(rows && stride >= n && stride % ISO_GRAM_LANES == 0);
    for (int i = 0; i < n_rows; i++) {
        for (int k = 0; k < stride; k++) {
            rows[i * stride + k] = k < n ? value((uint32_t)(i * n + k)) : 0.0f;
        }
    }
    return rows;
}

/* Whether a variant of this machine computes the same bits as the baseline. */
static void check_variant(iso_gram_function *variant, int n_rows, int n)
{
    float *rows = new_rows(n_rows, n);
    double *first = calloc((size_t)n * (size_t)n, sizeof *first);
    double *second = calloc((size_t)n * (size_t)n, sizeof *second);
    assert_true(first && second);
    iso__gram_baseline(rows, n_rows, n, first);
    variant(rows, n_rows, n, second);
    assert_memory_equal(first, second, (size_t)n * (size_t)n * sizeof *first);
    free(second);
    free(first);
    free(rows);
}

/* The test is skipped without a variant. */
static void check_variant_of_all_sizes(iso_gram_function *variant)
{
    if (!variant) {
        skip();
    }
    for (int n = 1; n <= N_MAX; n++) {
        check_variant(variant, 131, n);
    }
    check_variant(variant, ROWS_MAX, N_MAX);
}

static void check(int n_rows, int n)
{
    const int stride = iso_gram_stride(n);
    float *rows = new_rows(n_rows, n);
    double *h = calloc((size_t)n * (size_t)n, sizeof *h);
    assert_non_null(h);
    iso_gram(rows, n_rows, n, h);
    for (int a = 0; a < n; a++) {
        for (int b = 0; b <= a; b++) {
            double sum = 0.0;
            for (int i = 0; i < n_rows; i++) {
                sum += (double)rows[i * stride + a] * (double)rows[i * stride + b];
            }
            assert_true(fabs(h[a * n + b] - sum) <= 1e-5 * (1.0 + sqrt(n_rows)));
        }
    }
    free(h);
    free(rows);
}

static void sums_are_those_of_double_precision(void **state)
{
    (void)state;
    const int sizes[] = {1, 3, 4, 5, 59, N_MAX};
    const int rows[] = {1, 127, 128, 129, ROWS_MAX};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
            check(rows[r], sizes[s]);
        }
    }
}

/* The variants for each kind of processor have the same bits. */
static void avx2_has_the_same_bits(void **state)
{
    iso_gram_function *variant = NULL;
    (void)state;
#if defined __x86_64__
    variant = __builtin_cpu_supports("avx2") ? iso__gram_avx2 : NULL;
#endif
    check_variant_of_all_sizes(variant);
}

static void avx512_has_the_same_bits(void **state)
{
    iso_gram_function *variant = NULL;
    (void)state;
#if defined __x86_64__
    variant = __builtin_cpu_supports("avx512f") ? iso__gram_avx512 : NULL;
#endif
    check_variant_of_all_sizes(variant);
}

static void no_rows_give_zero(void **state)
{
    (void)state;
    _Alignas(ISO_GRAM_ALIGNMENT) float none[ISO_GRAM_LANES] = {0};
    double h[4] = {1.0, 1.0, 1.0, 1.0};
    iso_gram(none, 0, 2, h);
    assert_true(h[0] == 0.0 && h[2] == 0.0 && h[3] == 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_those_of_double_precision),
        cmocka_unit_test(avx2_has_the_same_bits),
        cmocka_unit_test(avx512_has_the_same_bits),
        cmocka_unit_test(no_rows_give_zero),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
