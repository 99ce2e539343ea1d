/* The order of a factor: a new pattern, and one that comes back. What is solved with it is tested
 * by test_block.c and by the solvers of heat. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/heat/block.h"
#include "core/heat/factor.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"

/* Factorises B + 15 L and solves for 1 at the vertex in the middle. Returns the number of entries
 * of the factor. */
static int64_t solve_once(struct iso_factor *factor, const struct matrices *m, double *x)
{
    const int32_t n = m->mass->n;
    const int32_t *order;
    struct iso_ldl ldl;
    int64_t entries = 0;

    assert_int_equal(iso_factor_compute(factor, 15.0, m->stiffness, 1.0, m->mass), 0);
    memset(x, 0, (size_t)n * sizeof *x);
    x[n / 2] = 1.0;
    assert_int_equal(iso_factor_solve(factor, x, 1, x), 0);
    assert_int_equal(iso_factor_ldl(factor, &ldl, &order), 0);
    for (int32_t j = 0; j < n; j++) {
        entries += ldl.count[j];
    }
    return entries;
}

static void a_pattern_that_comes_back_has_a_smaller_factor(void **state)
{
    (void)state;
    enum { CALLS = 3 };
    struct iso_mesh *mesh = shape_relief(1.5), *other = shape_relief(7.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct matrices m2 = matrices_of(other, ISO_MASS_CONSISTENT);
    const size_t n = (size_t)m.mass->n;
    struct iso_factor *factor = NULL;
    int64_t entries[CALLS + 1];
    double *x[CALLS + 1], off = 0.0;

    assert_int_equal(iso_factor_new(m.mass->n, m.mass->nnz, &factor), 0);
    for (int i = 0; i <= CALLS; i++) {
        x[i] = calloc(n, sizeof *x[i]);
        assert_non_null(x[i]);
        if (i == CALLS) { /* another one between: the pattern is new again */
            (void)solve_once(factor, &m2, x[i]);
        }
        entries[i] = solve_once(factor, &m, x[i]);
    }
    for (size_t i = 0; i < n; i++) {
        off = fmax(off, fabs(x[1][i] - x[0][i]));
    }
    assert_true(entries[1] < entries[0]);
    assert_true(off < 1e-12 * x[0][n / 2]);
    assert_int_equal(entries[2], entries[1]);
    assert_memory_equal(x[2], x[1], n * sizeof *x[1]);
    assert_int_equal(entries[CALLS], entries[0]);
    assert_memory_equal(x[CALLS], x[0], n * sizeof *x[0]);
    for (int i = 0; i <= CALLS; i++) {
        free(x[i]);
    }
    iso_factor_free(factor);
    matrices_free(&m);
    matrices_free(&m2);
    iso_mesh_free(mesh);
    iso_mesh_free(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pattern_that_comes_back_has_a_smaller_factor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
