/* The weighted operator of chapter 5, compared with the plain one, with a closed form, and with
 * integrals by Monte Carlo. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isotherm/eigenpairs.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

static struct matrices weighted_of(const struct iso_mesh *mesh, enum iso_mass kind,
                                   const double *density)
{
    struct matrices m = {0};
    int32_t nnz = mesh->n_vertices + 3 * mesh->n_triangles;
    assert_int_equal(iso_symmetric_new(mesh->n_vertices, nnz, &m.stiffness), 0);
    assert_int_equal(iso_symmetric_new(mesh->n_vertices, nnz, &m.mass), 0);
    assert_int_equal(iso_stiffness_mass_weighted(mesh, kind, density, m.stiffness, m.mass), 0);
    return m;
}

static double *some_density(const struct iso_mesh *mesh)
{
    double *h = calloc((size_t)mesh->n_vertices, sizeof *h);
    assert_non_null(h);
    srand48(51);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        h[v] = 0.01 + 3.0 * drand48();
    }
    return h;
}

static void a_density_of_one_changes_nothing(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_relief(8.0);
    double *h = some_density(mesh);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        h[v] = 1.0;
    }
    for (enum iso_mass kind = ISO_MASS_CONSISTENT; kind <= ISO_MASS_LUMPED; kind++) {
        struct matrices plain = matrices_of(mesh, kind), weighted = weighted_of(mesh, kind, h);
        assert_int_equal(plain.mass->nnz, weighted.mass->nnz);
        for (int32_t i = 0; i < plain.mass->nnz; i++) {
            assert_near(weighted.mass->value[i], plain.mass->value[i],
                        1e-14 * fabs(plain.mass->value[i]));
            assert_near(weighted.stiffness->value[i], plain.stiffness->value[i], 1e-14);
        }
        matrices_free(&plain);
        matrices_free(&weighted);
    }
    free(h);
    iso_mesh_free(mesh);
}

/* For any density the null vector is constant, no eigenvalue is negative, and x' B x > 0. Lumped
 * rows are the sums of consistent ones. A matrix stores only its lower triangle, so that it is
 * symmetric. */
static void every_density_keeps_the_operator_valid(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_relief(8.0);
    size_t n = (size_t)mesh->n_vertices;
    double *h = some_density(mesh), *one = calloc(n, sizeof *one),
           *image = calloc(n, sizeof *image);
    assert_true(one && image);
    struct matrices m = weighted_of(mesh, ISO_MASS_CONSISTENT, h);
    struct matrices lumped = weighted_of(mesh, ISO_MASS_LUMPED, h);
    for (size_t v = 0; v < n; v++) {
        one[v] = 1.0;
    }
    iso_symmetric_multiply(m.stiffness, one, image);
    for (size_t v = 0; v < n; v++) {
        assert_near(image[v], 0.0, 1e-12);
    }
    iso_symmetric_multiply(m.mass, one, image);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        assert_near(lumped.mass->value[lumped.mass->column_start[v]], image[v], 1e-12 * image[v]);
    }
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 12, 0.0, &pairs), 0);
    assert_near(pairs->lambda[0], 0.0, 1e-10 * pairs->lambda[11]);
    for (int i = 1; i < 12; i++) {
        assert_true(pairs->lambda[i] > 1e-6 * pairs->lambda[11]);
        const double *phi = &pairs->phi[(size_t)i * n];
        assert_near(matrices_form(m.mass, phi, phi), 1.0, 1e-9);
        assert_near(matrices_form(m.stiffness, phi, phi), pairs->lambda[i],
                    1e-6 * pairs->lambda[11]);
    }
    iso_eigenpairs_free(pairs);
    matrices_free(&m);
    matrices_free(&lumped);
    free(h);
    free(one);
    free(image);
    iso_mesh_free(mesh);
}

enum { CORNERS = 4, TRIANGLES = 2 };

static const int32_t two_triangles[TRIANGLES][3] = {{0, 1, 2}, {1, 3, 2}};

/* Two triangles that share an edge. */
static struct iso_mesh *new_two_triangles(void)
{
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(CORNERS, TRIANGLES, &mesh), 0);
    const struct iso_vec3 at[CORNERS] = {{0, 0, 0}, {4, 1, 0}, {1, 3, 2}, {5, 4, 1}};
    memcpy(mesh->vertices_mm, at, sizeof at);
    memcpy(mesh->triangles, two_triangles, sizeof two_triangles);
    mesh->n_vertices = CORNERS;
    mesh->n_triangles = TRIANGLES;
    return mesh;
}

/* Integrals over one triangle by Monte Carlo: those of h phi_i phi_j are added to b. Returns the
 * mean of h. */
static double sample_triangle(const struct iso_mesh *mesh, int t, const double h[CORNERS],
                              double b[CORNERS][CORNERS])
{
    enum { SAMPLES = 400000 };
    const int32_t *corner = two_triangles[t];
    const double area = iso_mesh_triangle_area(mesh, t);
    double mean = 0.0;
    for (int s = 0; s < SAMPLES; s++) {
        double u = drand48(), v = drand48();
        const double phi[3] = {u + v > 1.0 ? u + v - 1.0 : 1.0 - u - v, u + v > 1.0 ? 1.0 - u : u,
                               u + v > 1.0 ? 1.0 - v : v};
        double density = 0.0;
        for (int i = 0; i < 3; i++) {
            density += phi[i] * h[corner[i]];
        }
        mean += density / SAMPLES;
        for (int i = 0; i < 9; i++) {
            b[corner[i / 3]][corner[i % 3]] += phi[i / 3] * phi[i % 3] * density * area / SAMPLES;
        }
    }
    return mean;
}

/* column[j][i]: entry (i, j) of a. */
static void columns_of(const struct iso_symmetric *a, double column[CORNERS][CORNERS])
{
    for (int j = 0; j < CORNERS; j++) {
        double unit[CORNERS] = {0};
        unit[j] = 1.0;
        iso_symmetric_multiply(a, unit, column[j]);
    }
}

/* The stiffness of one triangle alone, without a density. */
static void stiffness_of_triangle(const struct iso_mesh *mesh, int t,
                                  double column[CORNERS][CORNERS])
{
    struct iso_mesh one = *mesh;
    one.triangles = &mesh->triangles[t];
    one.n_triangles = 1;
    struct matrices alone = matrices_of(&one, ISO_MASS_CONSISTENT);
    columns_of(alone.stiffness, column);
    matrices_free(&alone);
}

/* Equations 5.11 and 5.12, and 5.13 with h averaged over the triangle: integrals over two triangles
 * that share an edge, with a density of 0.2 to 5 at the corners. The stiffness is that of each
 * triangle by itself, times the density's mean as it was sampled. */
static void entries_are_weighted_integrals(void **state)
{
    (void)state;
    const double h[CORNERS] = {0.2, 5.0, 1.3, 2.6};
    struct iso_mesh *mesh = new_two_triangles();
    struct matrices m = weighted_of(mesh, ISO_MASS_CONSISTENT, h);
    double b[CORNERS][CORNERS] = {{0}}, mean[TRIANGLES], conducted[TRIANGLES][CORNERS][CORNERS];
    double mass[CORNERS][CORNERS], stiffness[CORNERS][CORNERS];
    srand48(512);
    for (int t = 0; t < TRIANGLES; t++) {
        mean[t] = sample_triangle(mesh, t, h, b);
        stiffness_of_triangle(mesh, t, conducted[t]);
    }
    columns_of(m.mass, mass);
    columns_of(m.stiffness, stiffness);
    for (int j = 0; j < CORNERS; j++) {
        for (int i = 0; i < CORNERS; i++) {
            assert_near(mass[j][i], b[i][j], 0.01 * b[j][j]);
            assert_near(stiffness[j][i],
                        mean[0] * conducted[0][j][i] + mean[1] * conducted[1][j][i], 0.01);
        }
    }
    matrices_free(&m);
    iso_mesh_free(mesh);
}

/* A narrow strip whose density grows as x carries the radial waves of a disc: (1/x) (x u')' =
 * -lambda u, lambda = (j'_0k / R)^2 (Abramowitz and Stegun, table 9.5). */
static void a_strip_as_dense_as_x_is_a_disc(void **state)
{
    (void)state;
    enum { COLUMNS = 201, ROWS = 3 };
    const double zero[] = {0.0, 3.83171, 7.01559, 10.17347};
    struct iso_mesh *mesh = shape_sheet(COLUMNS, ROWS, 0.1);
    double h[COLUMNS * ROWS], radius = 0.1 * (COLUMNS - 1);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        h[v] = fmax(1e-6, mesh->vertices_mm[v].x + radius / 2.0);
    }
    struct matrices m = weighted_of(mesh, ISO_MASS_CONSISTENT, h);
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 4, 0.0, &pairs), 0);
    for (int i = 1; i < 4; i++) {
        double expected = zero[i] * zero[i] / (radius * radius);
        print_message("weighted strip, wave %d: %.5f of %.5f\n", i, pairs->lambda[i], expected);
        assert_near(pairs->lambda[i], expected, 1e-3 * expected);
    }
    iso_eigenpairs_free(pairs);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

static void impossible_densities_are_refused(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sheet(4, 3, 1.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_LUMPED);
    const double wrong[] = {0.0, -1.0, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        double *h = some_density(mesh);
        h[7] = wrong[i];
        assert_int_equal(iso_stiffness_mass_weighted(mesh, ISO_MASS_LUMPED, h, m.stiffness, m.mass),
                         -EINVAL);
        free(h);
    }
    matrices_free(&m);
    iso_mesh_free(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_density_of_one_changes_nothing),
        cmocka_unit_test(every_density_keeps_the_operator_valid),
        cmocka_unit_test(entries_are_weighted_integrals),
        cmocka_unit_test(a_strip_as_dense_as_x_is_a_disc),
        cmocka_unit_test(impossible_densities_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
