/* Eigenpairs of surfaces with a known spectrum. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "isotherm/eigenpairs.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"

/* These shapes are symmetric and have multiple eigenvalues. 0 is machine precision. */
static const double tight = 0.0;

static struct iso_eigenpairs *solve(const struct iso_mesh *mesh, int k)
{
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, k, tight, &pairs), 0);
    assert_int_equal(pairs->n, mesh->n_vertices);
    assert_int_equal(pairs->k, k);
    matrices_free(&m);
    return pairs;
}

static void expect_values(const struct iso_eigenpairs *pairs, const double *expected, int k,
                          double tolerance)
{
    assert_true(fabs(pairs->lambda[0]) < 1e-9 * expected[k - 1]);
    for (int i = 1; i < k; i++) {
        double off = pairs->lambda[i] / expected[i] - 1.0;
        if (!(fabs(off) < tolerance)) {
            fail_msg("eigenvalue %d is %g, expected %g", i, pairs->lambda[i], expected[i]);
        }
    }
}

/* The sphere has the eigenvalues l (l + 1) / R^2, each 2 l + 1 times. */
static void a_sphere_has_its_harmonics(void **state)
{
    (void)state;
    const double radius = 20.0;
    enum { K = 36 }; /* l = 0..5 */
    struct iso_mesh *mesh = shape_sphere(4, radius);
    struct iso_eigenpairs *pairs = solve(mesh, K);
    double expected[K];
    for (int l = 0, i = 0; l < 6; l++) {
        for (int m = -l; m <= l; m++, i++) {
            expected[i] = l * (l + 1) / (radius * radius);
        }
    }
    expect_values(pairs, expected, K, 0.015);
    /* The mesh has the symmetry of the icosahedron, so that l = 1 and l = 2 stay exactly multiple.
     */
    assert_true(pairs->lambda[3] / pairs->lambda[1] - 1.0 < 1e-9);
    assert_true(pairs->lambda[8] / pairs->lambda[4] - 1.0 < 1e-9);
    iso_eigenpairs_free(pairs);
    iso_mesh_free(mesh);
}

static void fold_entries(double *dense, const struct iso_symmetric *a, const int32_t *fold,
                         int32_t n)
{
    for (int32_t j = 0; j < a->n; j++) {
        for (int32_t at = a->column_start[j]; at < a->column_start[j + 1]; at++) {
            int32_t p = fold[j], q = fold[a->row[at]];
            dense[p * n + q] += a->value[at];
            if (a->row[at] != j) {
                dense[q * n + p] += a->value[at];
            }
        }
    }
}

/* Joins vertices of a mesh: vertex i becomes vertex fold[i] of n vertices (P' A P, by way of a
 * dense matrix). Both results store the entries at which the mass is not 0, so that they have the
 * same pattern. */
static struct matrices fold_matrices(const struct matrices *flat, const int32_t *fold, int32_t n)
{
    size_t entries = (size_t)n * (size_t)n;
    double *stiffness = calloc(entries, sizeof(double)), *mass = calloc(entries, sizeof(double));
    assert_true(stiffness && mass);
    fold_entries(stiffness, flat->stiffness, fold, n);
    fold_entries(mass, flat->mass, fold, n);
    struct matrices m = {0};
    assert_int_equal(iso_symmetric_new(n, flat->stiffness->nnz, &m.stiffness), 0);
    assert_int_equal(iso_symmetric_new(n, flat->stiffness->nnz, &m.mass), 0);
    int32_t nnz = 0;
    for (int32_t j = 0; j < n; j++) {
        m.stiffness->column_start[j] = m.mass->column_start[j] = nnz;
        for (int32_t i = j; i < n; i++) {
            if (mass[i * n + j] != 0.0) {
                m.stiffness->row[nnz] = m.mass->row[nnz] = i;
                m.stiffness->value[nnz] = stiffness[i * n + j];
                m.mass->value[nnz++] = mass[i * n + j];
            }
        }
    }
    m.stiffness->column_start[n] = m.mass->column_start[n] = nnz;
    m.stiffness->nnz = m.mass->nnz = nnz;
    m.stiffness->n = m.mass->n = n;
    free(stiffness);
    free(mass);
    return m;
}

static int ascending(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* The flat torus of w x h has the eigenvalues 4 pi^2 (a^2 / w^2 + b^2 / h^2) for whole a and b. It
 * does not fit into space. Its matrices are those of a sheet whose opposite sides are joined. */
static void a_flat_torus_has_its_waves(void **state)
{
    (void)state;
    enum { COLUMNS = 48, ROWS = 32, K = 21, WAVES = 7 };
    struct iso_mesh *sheet = shape_sheet(COLUMNS + 1, ROWS + 1, 1.0);
    struct matrices flat = matrices_of(sheet, ISO_MASS_CONSISTENT);
    int32_t fold[(COLUMNS + 1) * (ROWS + 1)];
    for (int i = 0; i < (COLUMNS + 1) * (ROWS + 1); i++) {
        fold[i] = (i / (COLUMNS + 1) % ROWS) * COLUMNS + i % (COLUMNS + 1) % COLUMNS;
    }
    struct matrices torus = fold_matrices(&flat, fold, COLUMNS * ROWS);
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(torus.stiffness, torus.mass, K, tight, &pairs), 0);
    double expected[(2 * WAVES + 1) * (2 * WAVES + 1)];
    int n = 0;
    for (int a = -WAVES; a <= WAVES; a++) {
        for (int b = -WAVES; b <= WAVES; b++) {
            double u = (double)a / COLUMNS, v = (double)b / ROWS;
            expected[n++] = 4.0 * M_PI * M_PI * (u * u + v * v);
        }
    }
    qsort(expected, (size_t)n, sizeof expected[0], ascending);
    expect_values(pairs, expected, K, 0.03);
    /* The lowest wave runs along the longer side, once as sine and once as cosine. */
    assert_true(pairs->lambda[2] / pairs->lambda[1] - 1.0 < 1e-8);
    assert_true(pairs->lambda[3] / pairs->lambda[2] > 1.5);
    iso_eigenpairs_free(pairs);
    matrices_free(&torus);
    matrices_free(&flat);
    iso_mesh_free(sheet);
}

/* Zeros of the derivatives of the Bessel functions J_m, each with its multiplicity (Abramowitz and
 * Stegun, table 9.5). */
static const double bessel_zeros[] = {0.0,     1.84118, 1.84118, 3.05424, 3.05424, 3.83171,
                                      4.20119, 4.20119, 5.31755, 5.31755, 5.33144, 5.33144,
                                      6.41562, 6.41562, 6.70613, 6.70613, 7.01559};

/* The disc with an insulated border has the eigenvalues (j'_mk / R)^2. */
static void a_disc_has_its_bessel_zeros(void **state)
{
    (void)state;
    enum { K = sizeof bessel_zeros / sizeof bessel_zeros[0] };
    const double radius = 30.0;
    struct iso_mesh *mesh = shape_disc(36, radius);
    assert_int_equal(iso_mesh_check(mesh, NULL), 0);
    struct iso_eigenpairs *pairs = solve(mesh, K);
    double expected[K];
    for (int i = 0; i < K; i++) {
        expected[i] = bessel_zeros[i] * bessel_zeros[i] / (radius * radius);
    }
    expect_values(pairs, expected, K, 0.006);
    iso_eigenpairs_free(pairs);
    iso_mesh_free(mesh);
}

/* Asserts that the error falls with order two when the size of the elements halves. */
static void expect_order_two(const char *name, const double *error, int n)
{
    for (int i = 1; i < n; i++) {
        double order = log2(error[i - 1] / error[i]);
        print_message("%s: relative error %.2e -> %.2e, order %.3f\n", name, error[i - 1], error[i],
                      order);
        assert_true(order > 1.8 && order < 2.2);
    }
}

static void eigenvalues_converge_with_order_two(void **state)
{
    (void)state;
    enum { SIZES = 3 };
    double sphere[SIZES], disc[SIZES];
    for (int i = 0; i < SIZES; i++) {
        struct iso_mesh *mesh = shape_sphere(2 + i, 10.0);
        struct iso_eigenpairs *pairs = solve(mesh, 9);
        sphere[i] = fabs(pairs->lambda[8] / 0.06 - 1.0); /* l = 2 */
        iso_eigenpairs_free(pairs);
        iso_mesh_free(mesh);
        mesh = shape_disc(9 << i, 10.0);
        pairs = solve(mesh, 6);
        disc[i] = fabs(pairs->lambda[5] / (0.01 * 3.83170597 * 3.83170597) - 1.0);
        iso_eigenpairs_free(pairs);
        iso_mesh_free(mesh);
    }
    expect_order_two("sphere, l = 2", sphere, SIZES);
    expect_order_two("disc, j'_01", disc, SIZES);
}

/* Solves, and checks that the pairs are ascending, orthonormal, and solve the problem. */
static struct iso_eigenpairs *solve_and_check(const struct iso_mesh *mesh, int k)
{
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, k, tight, &pairs), 0);
    size_t n = (size_t)pairs->n;
    double *left = calloc(n, sizeof *left), *right = calloc(n, sizeof *right);
    assert_true(left && right);
    for (int i = 0; i < k; i++) {
        const double *phi = &pairs->phi[(size_t)i * n];
        assert_true(i == 0 || pairs->lambda[i] >= pairs->lambda[i - 1]);
        for (int j = 0; j <= i; j++) {
            double product = matrices_form(m.mass, phi, &pairs->phi[(size_t)j * n]);
            assert_true(fabs(product - (i == j)) < 1e-9);
        }
        iso_symmetric_multiply(m.stiffness, phi, left);
        iso_symmetric_multiply(m.mass, phi, right);
        for (size_t v = 0; v < n; v++) {
            assert_true(fabs(left[v] - pairs->lambda[i] * right[v]) < 1e-9);
        }
    }
    free(left);
    free(right);
    matrices_free(&m);
    return pairs;
}

static void pairs_are_orthonormal_and_solve_the_problem(void **state)
{
    struct iso_mesh *mesh = shape_sheet(31, 23, 1.5);
    (void)state;
    iso_eigenpairs_free(solve_and_check(mesh, 20));
    iso_mesh_free(mesh);
}

/* The basis of few vertices becomes the whole space, of which the last panel may not be full. */
static void the_whole_space_is_a_basis(void **state)
{
    (void)state;
    for (int columns = 3; columns <= 12; columns++) {
        struct iso_mesh *mesh = shape_sheet(columns, 3, 1.0);
        for (int k = 1; k <= mesh->n_vertices / 2; k++) {
            iso_eigenpairs_free(solve_and_check(mesh, k));
        }
        iso_mesh_free(mesh);
    }
}

/* From 10,000 vertices on the basis is restarted. The sphere has 1 + 3 + ... + 19 = 100 pairs with
 * l < 10. */
static void a_large_sphere_has_its_harmonics(void **state)
{
    enum { K = 100 };
    const double radius = 20.0;
    struct iso_mesh *mesh = shape_sphere(5, radius);
    double expected[K];
    (void)state;
    assert_true(mesh->n_vertices > 10000);
    for (int l = 0, i = 0; l < 10; l++) {
        for (int m = -l; m <= l; m++, i++) {
            expected[i] = l * (l + 1) / (radius * radius);
        }
    }
    struct iso_eigenpairs *pairs = solve_and_check(mesh, K);
    expect_values(pairs, expected, K, 0.01);
    iso_eigenpairs_free(pairs);
    iso_mesh_free(mesh);
}

/* There are more spheres than the first block of the solver has vectors (8). The lowest eigenvalue
 * occurs once for each sphere, the next one 3 times for each. */
static void every_copy_is_found(void **state)
{
    (void)state;
    enum { SPHERES = 9, K = 4 * SPHERES };
    const double radius = 3.0;
    struct iso_mesh *one = shape_sphere(2, radius), *all = NULL;
    int32_t nv = one->n_vertices, nt = one->n_triangles;
    assert_int_equal(iso_mesh_new(SPHERES * nv, SPHERES * nt, &all), 0);
    for (int32_t i = 0; i < SPHERES * nv; i++) {
        struct iso_vec3 aside = iso_vec3(10.0 * (i / nv), 0, 0);
        all->vertices_mm[i] = iso_add(one->vertices_mm[i % nv], aside);
    }
    for (int32_t t = 0; t < SPHERES * nt; t++) {
        for (int k = 0; k < 3; k++) {
            all->triangles[t][k] = one->triangles[t % nt][k] + t / nt * nv;
        }
    }
    all->n_vertices = SPHERES * nv;
    all->n_triangles = SPHERES * nt;
    struct iso_eigenpairs *pairs = solve(all, K);
    for (int i = 0; i < SPHERES; i++) {
        assert_true(fabs(pairs->lambda[i]) < 1e-10);
    }
    for (int i = SPHERES; i < K; i++) {
        assert_true(fabs(pairs->lambda[i] * radius * radius / 2.0 - 1.0) < 0.03);
        assert_true(fabs(pairs->lambda[i] / pairs->lambda[SPHERES] - 1.0) < 1e-9);
    }
    iso_eigenpairs_free(pairs);
    iso_mesh_free(all);
    iso_mesh_free(one);
}

static void impossible_requests_are_refused(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sheet(5, 4, 1.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_LUMPED);
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 0, tight, &pairs), -EINVAL);
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 11, tight, &pairs), -EINVAL);
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 5, -1e-9, &pairs), -EINVAL);
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 5, NAN, &pairs), -EINVAL);
    m.stiffness->value[7] = NAN;
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 5, tight, &pairs), -EDOM);
    matrices_free(&m);
    iso_mesh_free(mesh);
    mesh = shape_sheet(7, 1 + 1, 1.0);
    m = matrices_of(mesh, ISO_MASS_LUMPED);
    for (int32_t i = 0; i < m.stiffness->nnz; i++) {
        m.stiffness->value[i] *= -1.0; /* no longer semi-definite */
    }
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 3, tight, &pairs), -EDOM);
    matrices_free(&m);
    iso_mesh_free(mesh);
    mesh = shape_sheet(3, 2, 1.0); /* fewer than 8 vertices */
    m = matrices_of(mesh, ISO_MASS_LUMPED);
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 2, tight, &pairs), -EINVAL);
    assert_null(pairs);
    matrices_free(&m);
    iso_mesh_free(mesh);
    iso_eigenpairs_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_has_its_harmonics),
        cmocka_unit_test(a_flat_torus_has_its_waves),
        cmocka_unit_test(a_disc_has_its_bessel_zeros),
        cmocka_unit_test(eigenvalues_converge_with_order_two),
        cmocka_unit_test(pairs_are_orthonormal_and_solve_the_problem),
        cmocka_unit_test(the_whole_space_is_a_basis),
        cmocka_unit_test(a_large_sphere_has_its_harmonics),
        cmocka_unit_test(every_copy_is_found),
        cmocka_unit_test(impossible_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
