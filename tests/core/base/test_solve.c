/* Small dense systems: the factor is that of the textbook's loop to the bit, and it solves. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/base/solve.h"

enum { N_MAX = 102 };

static double value(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (double)*state / 2147483648.0 - 1.0;
}

/* B B' + a diagonal. NaN above the diagonal would be in the factor if it had an influence. */
static void make_matrix(int n, uint32_t seed, double *a)
{
    static double b[N_MAX * N_MAX];
    for (int i = 0; i < n * n; i++) {
        b[i] = value(&seed);
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            double sum = i == j ? 0.5 + 0.1 * i : 0.0;
            for (int k = 0; k < n; k++) {
                sum += b[i * n + k] * b[j * n + k];
            }
            a[i * n + j] = j <= i ? sum : NAN;
        }
    }
}

/* Cholesky's method, row by row as in textbooks. */
static void factorise_plainly(double *a, int n)
{
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            double sum = a[i * n + j];
            for (int k = 0; k < j; k++) {
                sum -= a[i * n + k] * a[j * n + k];
            }
            a[i * n + j] = i == j ? sqrt(sum) : sum / a[j * n + j];
        }
    }
}

static void check_factors(int (*factorise)(double *a, int n))
{
    static double a[N_MAX * N_MAX], plain[N_MAX * N_MAX];
    for (int n = 1; n <= N_MAX; n += n < 20 ? 1 : 9) {
        make_matrix(n, (uint32_t)n, a);
        memcpy(plain, a, (size_t)n * (size_t)n * sizeof *a);
        factorise_plainly(plain, n);
        assert_int_equal(factorise(a, n), 0);
        for (int i = 0; i < n; i++) {
            for (int j = 0; j <= i; j++) {
#if defined __x86_64__
                assert_memory_equal(&a[i * n + j], &plain[i * n + j], sizeof *a);
#else /* the compiler may join a product and a difference in one of the two */
                assert_true(fabs(a[i * n + j] - plain[i * n + j]) <= 1e-12 * (n + 1.0));
#endif
            }
        }
    }
}

static void factor_is_that_of_the_plain_loop(void **state)
{
    (void)state;
    check_factors(iso_cholesky_factorise);
    check_factors(iso__cholesky_factorise_baseline);
}

static void solution_satisfies_the_system(void **state)
{
    (void)state;
    static double a[N_MAX * N_MAX], l[N_MAX * N_MAX];
    const int n = 78;
    double x[N_MAX], b[N_MAX] = {0};
    make_matrix(n, 5, a);
    memcpy(l, a, sizeof l);
    for (int i = 0; i < n; i++) {
        x[i] = sin(i + 1.0);
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            b[i] += (j <= i ? a[i * n + j] : a[j * n + i]) * x[j];
        }
    }
    assert_int_equal(iso_cholesky_factorise(l, n), 0);
    iso_cholesky_solve(l, n, b);
    for (int i = 0; i < n; i++) {
        assert_true(fabs(b[i] - x[i]) < 1e-9);
    }
}

/* Each of the columns in turn depends on the ones before it, or is not a number. */
static void singular_matrices_are_refused(void **state)
{
    (void)state;
    static double a[N_MAX * N_MAX];
    const int n = 11;
    for (int bad = 0; bad < n; bad++) {
        make_matrix(n, 3, a);
        a[bad * n + bad] = -1.0;
        assert_int_equal(iso_cholesky_factorise(a, n), -EDOM);
        make_matrix(n, 3, a);
        a[bad * n + bad] = NAN;
        assert_int_equal(iso_cholesky_factorise(a, n), -EDOM);
    }
    double twice[4] = {4.0, NAN, 2.0, 1.0};
    assert_int_equal(iso_cholesky_factorise(twice, 2), -EDOM);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(factor_is_that_of_the_plain_loop),
        cmocka_unit_test(solution_satisfies_the_system),
        cmocka_unit_test(singular_matrices_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
