/* Products of panels, for each kind of processor, and Cholesky's factor of eight vectors. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/heat/panel.h"
#include "core/heat/small_cholesky.h"

enum { N = ISO_PANEL, ROWS = 271 }; /* not a multiple of the rows that are processed at once */

static double number(int at, int series)
{
    return sin(0.37 * at * at * (series + 1) + series) + 0.1 * series;
}

static void fill(double *panel, int rows, int series)
{
    for (int i = 0; i < rows * N; i++) {
        panel[i] = number(i, series);
    }
}

static void expect_near(double found, double expected)
{
    assert_true(fabs(found - expected) < 1e-12 * (1.0 + fabs(expected)));
}

static void check_operations(const struct iso_panel_ops *ops)
{
    static double u[ROWS * N], w[ROWS * N], turned[ROWS * N];
    double product[N][N], weight[N][N];
    fill(u, ROWS, 1);
    fill(w, ROWS, 2);
    fill(turned, ROWS, 2);
    fill(&product[0][0], N, 3);
    fill(&weight[0][0], N, 4);
    ops->dot(ROWS, u, w, product);
    for (int i = 0; i < N; i++) {
        for (int c = 0; c < N; c++) {
            double sum = number(i * N + c, 3);
            for (int row = 0; row < ROWS; row++) {
                sum += u[row * N + i] * w[row * N + c];
            }
            expect_near(product[i][c], sum);
        }
    }
    ops->add(ROWS, u, (const double(*)[N])weight, w);
    ops->multiply(ROWS, (const double(*)[N])weight, turned);
    for (int row = 0; row < ROWS; row++) {
        for (int c = 0; c < N; c++) {
            double added = number(row * N + c, 2), sum = 0.0;
            for (int i = 0; i < N; i++) {
                added += u[row * N + i] * weight[i][c];
                sum += number(row * N + i, 2) * weight[i][c];
            }
            expect_near(w[row * N + c], added);
            expect_near(turned[row * N + c], sum);
        }
    }
}

static void panels_are_multiplied(void **state)
{
    (void)state;
    check_operations(&iso__panel_ops_baseline);
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        check_operations(&iso__panel_ops_fma);
        assert_ptr_equal(iso_panel_ops(), &iso__panel_ops_fma);
    }
#endif
}

/* gram = w' w. Vector `like` of w is vector 1 of w, but for `off` at one place. */
static void make_gram(int like, double off, double (*gram)[N])
{
    double w[16 * N];
    fill(w, 16, 5);
    for (int row = 0; like >= 0 && row < 16; row++) {
        w[row * N + like] = w[row * N + 1] + (row == 3 ? off : 0.0);
    }
    memset(gram, 0, N * sizeof *gram);
    iso__panel_ops_baseline.dot(16, w, w, gram);
}

static void a_factor_makes_vectors_orthonormal(void **state)
{
    (void)state;
    double gram[N][N], r[N][N] = {{0}}, inverse[N][N];
    for (int i = 0; i < N; i++) {
        r[i][i] = i + 1.0;
    }
    make_gram(-1, 0.0, gram);
    assert_true(iso_small_cholesky((const double(*)[N])gram, 1.0, r, inverse));
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            double square = 0.0, one = 0.0;
            for (int k = 0; k < N; k++) { /* r is R times the diagonal of before */
                square += r[k][i] / (i + 1.0) * (r[k][j] / (j + 1.0));
                one += r[i][k] / (k + 1.0) * inverse[k][j];
            }
            expect_near(square, gram[i][j]);
            expect_near(one, i == j ? 1.0 : 0.0);
        }
    }
}

static void dependent_vectors_have_no_factor(void **state)
{
    (void)state;
    double gram[N][N], r[N][N] = {{0}}, before[N][N] = {{0}}, inverse[N][N];
    r[2][3] = before[2][3] = 7.0;
    make_gram(6, 1e-6, gram);
    assert_false(iso_small_cholesky((const double(*)[N])gram, 1.0, r, inverse));
    assert_memory_equal(r, before, sizeof r);
    make_gram(6, 1e-2, gram);
    assert_false(iso_small_cholesky((const double(*)[N])gram, 1e15, r, inverse));
    assert_memory_equal(r, before, sizeof r);
    assert_true(iso_small_cholesky((const double(*)[N])gram, 1.0, r, inverse));
    gram[4][4] = NAN;
    assert_false(iso_small_cholesky((const double(*)[N])gram, 1.0, r, inverse));
    gram[4][4] = INFINITY;
    assert_false(iso_small_cholesky((const double(*)[N])gram, 1.0, r, inverse));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(panels_are_multiplied),
        cmocka_unit_test(a_factor_makes_vectors_orthonormal),
        cmocka_unit_test(dependent_vectors_have_no_factor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
