/* Factors by supernodes: they are those of CHOLMOD, also with wide supernodes and negative pivots.
 */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/heat/block.h"
#include "core/heat/factor.h"
#include "core/heat/supernodes.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"

static size_t values_of(const struct iso_ldl *l)
{
    size_t end = 0;
    for (int32_t j = 0; j < l->n; j++) {
        const size_t last = (size_t)l->start[j] + (size_t)l->count[j];
        end = end > last ? end : last;
    }
    return end;
}

/* Compares with the factor of CHOLMOD, which is the first one of `factor`. Returns the largest
 * number of columns of a supernode. */
static int32_t expect_cholmod(const struct iso_symmetric *matrix)
{
    struct iso_factor *factor = NULL;
    struct iso_supernodes *nodes = NULL;
    const int32_t *order;
    struct iso_ldl l;
    int32_t run = 1, widest = 1;
    assert_int_equal(iso_factor_new(matrix->n, matrix->nnz, &factor), 0);
    assert_int_equal(iso_factor_compute(factor, 1.0, matrix, 0.0, matrix), 0);
    assert_int_equal(iso_factor_ldl(factor, &l, &order), 0);
    assert_int_equal(iso_supernodes_new(&l, order, matrix, &nodes), 0);
    double *value = malloc(values_of(&l) * sizeof *value);
    assert_non_null(value);
    for (int again = 0; again < 2; again++) {
        assert_int_equal(iso_supernodes_factorise(nodes, matrix, value), 0);
        for (int32_t j = 0; j < l.n; j++) {
            for (int32_t at = l.start[j]; at < l.start[j] + l.count[j]; at++) {
                const double size = at == l.start[j] ? fabs(l.value[at]) : 1.0;
                assert_true(fabs(value[at] - l.value[at]) < 1e-11 * size);
            }
        }
    }
    for (int32_t j = 1; j < l.n; j++) {
        run = iso_ldl_joins_next(&l, j - 1) ? run + 1 : 1;
        widest = widest > run ? widest : run;
    }
    free(value);
    iso_supernodes_free(nodes);
    iso_factor_free(factor);
    return widest;
}

/* B + t L of a surface. */
static void add_stiffness(struct matrices *m, double t)
{
    for (int32_t i = 0; i < m->mass->nnz; i++) {
        m->mass->value[i] += t * m->stiffness->value[i];
    }
}

static void factors_are_those_of_cholmod(void **state)
{
    struct iso_mesh *meshes[] = {shape_sheet(3, 3, 1.0), shape_sheet(40, 2, 1.0), shape_relief(1.5),
                                 shape_sphere(5, 30.0)};
    (void)state;
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
        struct matrices m = matrices_of(meshes[i], ISO_MASS_CONSISTENT);
        add_stiffness(&m, 15.0);
        const int32_t widest = expect_cholmod(m.mass);
        print_message("%d vertices: the widest supernode has %d columns\n", m.mass->n, widest);
        matrices_free(&m);
        iso_mesh_free(meshes[i]);
    }
}

/* A matrix without zeros is one supernode, which is cut into pieces. */
static struct iso_symmetric *full_matrix(int32_t n, double diagonal)
{
    struct iso_symmetric *full = NULL;
    assert_int_equal(iso_symmetric_new(n, n * (n + 1) / 2, &full), 0);
    full->n = n;
    full->nnz = 0;
    for (int32_t j = 0; j < n; j++) {
        full->column_start[j] = full->nnz;
        for (int32_t i = j; i < n; i++) {
            full->row[full->nnz] = i;
            full->value[full->nnz++] = i == j ? diagonal : cos(1.0 + 3.7 * i + 1.9 * j);
        }
    }
    full->column_start[n] = full->nnz;
    return full;
}

static void wide_supernodes_are_cut(void **state)
{
    (void)state;
    for (int32_t n = 8; n <= 208; n += 40) {
        struct iso_symmetric *full = full_matrix(n, 100.0);
        assert_int_equal(expect_cholmod(full), n);
        iso_symmetric_free(full);
    }
}

/* L - limit B has as many negative pivots by both, as many as there are eigenvalues below the
 * limit. */
static void negative_pivots_are_counted(void **state)
{
    struct iso_mesh *mesh = shape_relief(1.5);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct iso_factor *once = NULL, *again = NULL;
    (void)state;
    assert_int_equal(iso_factor_new(m.mass->n, m.mass->nnz, &once), 0);
    assert_int_equal(iso_factor_new(m.mass->n, m.mass->nnz, &again), 0);
    for (double limit = 0.003; limit < 1.0; limit *= 3.0) {
        int32_t by_cholmod = -1, by_supernodes = -2;
        assert_int_equal(iso_factor_count_below(once, m.stiffness, limit, m.mass, &by_cholmod), 0);
        assert_int_equal(iso_factor_compute(again, 1.0, m.stiffness, 1.0, m.mass), 0);
        assert_int_equal(iso_factor_count_below(again, m.stiffness, limit, m.mass, &by_supernodes),
                         0);
        assert_int_equal(by_cholmod, by_supernodes);
        assert_true(by_cholmod > 0);
    }
    iso_factor_free(once);
    iso_factor_free(again);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

static void what_has_no_factor_is_refused(void **state)
{
    struct iso_symmetric *full = full_matrix(60, 100.0), *part = full_matrix(60, 100.0);
    struct iso_factor *factor = NULL;
    struct iso_supernodes *nodes = NULL;
    const int32_t *order;
    struct iso_ldl l;
    (void)state;
    /* A diagonal matrix, whose factor has no place for the entries of the full one. */
    part->nnz = part->n;
    for (int32_t j = 0; j < part->n; j++) {
        part->column_start[j] = part->row[j] = j;
        part->value[j] = 1.0;
    }
    part->column_start[part->n] = part->n;
    assert_int_equal(iso_factor_new(full->n, full->nnz, &factor), 0);
    assert_int_equal(iso_factor_compute(factor, 1.0, part, 0.0, part), 0);
    assert_int_equal(iso_factor_ldl(factor, &l, &order), 0);
    assert_int_equal(iso_supernodes_new(&l, order, full, &nodes), -EINVAL);
    assert_null(nodes);

    assert_int_equal(iso_factor_compute(factor, 1.0, full, 0.0, full), 0);
    assert_int_equal(iso_factor_ldl(factor, &l, &order), 0);
    assert_int_equal(iso_supernodes_new(&l, order, full, &nodes), 0);
    double *value = malloc(values_of(&l) * sizeof *value);
    assert_non_null(value);
    for (int32_t i = 0; i < full->nnz; i++) {
        full->value[i] = 1.0; /* the second pivot is 0 */
    }
    assert_int_equal(iso_supernodes_factorise(nodes, full, value), -EDOM);
    full->value[7] = NAN;
    assert_int_equal(iso_supernodes_factorise(nodes, full, value), -EDOM);
    free(value);
    iso_supernodes_free(nodes);
    iso_supernodes_free(NULL);
    iso_factor_free(factor);
    iso_symmetric_free(full);
    iso_symmetric_free(part);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(factors_are_those_of_cholmod),
        cmocka_unit_test(wide_supernodes_are_cut),
        cmocka_unit_test(negative_pivots_are_counted),
        cmocka_unit_test(what_has_no_factor_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
