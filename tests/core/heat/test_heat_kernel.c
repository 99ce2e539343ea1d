/* Columns of the heat kernel, compared with closed forms, and with each other where both methods
 * must agree. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isotherm/heat_kernel.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/reference_heat.h"
#include "tests/core/surfaces/shapes.h"

static double *column_room(const struct iso_mesh *mesh, int columns)
{
    double *out = calloc((size_t)columns * (size_t)mesh->n_vertices, sizeof *out);
    assert_non_null(out);
    return out;
}

static struct iso_heat_direct *new_solver(const struct matrices *m, int krylov)
{
    const struct iso_heat_direct_options options = {
        .n_capacity = m->mass->n_capacity,
        .nnz_capacity = m->mass->nnz_capacity,
        .krylov = krylov,
    };
    struct iso_heat_direct *solver = NULL;
    assert_int_equal(iso_heat_direct_new(&options, &solver), 0);
    return solver;
}

/* Returns the total heat 1' B K. */
static double total_heat(const struct iso_symmetric *mass, const double *heat)
{
    double *one = calloc((size_t)mass->n, sizeof *one);
    assert_non_null(one);
    for (int32_t i = 0; i < mass->n; i++) {
        one[i] = 1.0;
    }
    double total = matrices_form(mass, one, heat);
    free(one);
    return total;
}

/* Returns the largest relative error against exp(-r^2 / 4t) / (4 pi t) within r <= 3 sqrt(t) of (x,
 * y). */
static double planar_error(const struct iso_mesh *mesh, const double *heat, double x, double y,
                           double t_mm2)
{
    double worst = 0.0;
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        double r2 = pow(mesh->vertices_mm[i].x - x, 2) + pow(mesh->vertices_mm[i].y - y, 2);
        if (r2 <= 9.0 * t_mm2) {
            double exact = exp(-r2 / (4.0 * t_mm2)) / (4.0 * M_PI * t_mm2);
            worst = fmax(worst, fabs(heat[i] / exact - 1.0));
        }
    }
    return worst;
}

static void both_ways_give_the_planar_kernel(void **state)
{
    (void)state;
    enum { TIMES = 2 };
    const double t_mm2[TIMES] = {140.0, 100.0};
    struct iso_mesh *mesh = shape_sheet(127, 121, 1.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    /* The source is a vertex. A source inside a triangle is the mean of its corners, which spreads
     * the heat by up to a third of the pitch; the tests of isotherms cover this. */
    struct iso_surface_point source = shape_locate(mesh, 3.0, -2.0);
    double *heat = column_room(mesh, TIMES);
    struct iso_heat_direct *solver = new_solver(&m, 0);
    assert_int_equal(
        iso_heat_direct(solver, mesh, m.stiffness, m.mass, &source, 1, t_mm2, TIMES, heat), 0);
    for (int j = 0; j < TIMES; j++) {
        const double *column = &heat[(size_t)j * (size_t)mesh->n_vertices];
        double error = planar_error(mesh, column, 3.0, -2.0, t_mm2[j]);
        print_message("planar kernel, direct, t = %g: %.3f %%\n", t_mm2[j], 100.0 * error);
        assert_true(error < 0.005);
    }
    iso_heat_direct_free(solver);
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 100, 1e-10, &pairs), 0);
    iso_heat_spectral(pairs, mesh, &source, 1, t_mm2, TIMES, heat);
    for (int j = 0; j < TIMES; j++) {
        const double *column = &heat[(size_t)j * (size_t)mesh->n_vertices];
        double error = planar_error(mesh, column, 3.0, -2.0, t_mm2[j]);
        print_message("planar kernel, 100 eigenpairs, t = %g: %.3f %%\n", t_mm2[j], 100.0 * error);
        assert_true(error < 0.005);
    }
    iso_eigenpairs_free(pairs);
    free(heat);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

/* On the sphere K = sum (2 l + 1) / (4 pi R^2) exp(-l (l + 1) t / R^2) P_l(cos angle). */
static void a_sphere_has_its_legendre_series(void **state)
{
    (void)state;
    const double radius = 30.0, t_mm2 = 120.0;
    struct iso_mesh *mesh = shape_sphere(5, radius);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct iso_surface_point source = {.triangle = 77, .weight = {0, 1, 0}};
    struct iso_vec3 pole = iso_mesh_point_at(mesh, source);
    double *heat = column_room(mesh, 1);
    struct iso_heat_direct *solver = new_solver(&m, 0);
    assert_int_equal(
        iso_heat_direct(solver, mesh, m.stiffness, m.mass, &source, 1, &t_mm2, 1, heat), 0);
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        double x = iso_dot(mesh->vertices_mm[i], pole) / (radius * radius);
        double before = 0.0, legendre = 1.0, sum = 0.0;
        for (int l = 0; l < 60; l++) {
            sum += (2 * l + 1) * exp(-l * (l + 1) * t_mm2 / (radius * radius)) * legendre;
            double next = ((2 * l + 1) * x * legendre - l * before) / (l + 1);
            before = legendre;
            legendre = next;
        }
        double exact = sum / (4.0 * M_PI * radius * radius);
        if (x > 0.5) { /* 60 degrees, 31 mm */
            assert_true(fabs(heat[i] / exact - 1.0) < 0.01);
        }
    }
    iso_heat_direct_free(solver);
    free(heat);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

static void total_heat_is_conserved(void **state)
{
    (void)state;
    enum { SOURCES = 5, TIMES = 3 };
    const double t_mm2[TIMES] = {30.0, 200.0, 4000.0};
    struct iso_mesh *mesh = shape_relief(5.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct iso_surface_point source[SOURCES];
    for (int s = 0; s < SOURCES; s++) { /* the last one is near the border */
        source[s] = shape_locate(mesh, 3.0 - 17.0 * s, 2.0 + 11.0 * s);
    }
    double *heat = column_room(mesh, SOURCES * TIMES);
    struct iso_heat_direct *solver = new_solver(&m, 0);
    assert_int_equal(
        iso_heat_direct(solver, mesh, m.stiffness, m.mass, source, SOURCES, t_mm2, TIMES, heat), 0);
    for (int c = 0; c < SOURCES * TIMES; c++) {
        double total = total_heat(m.mass, &heat[(size_t)c * (size_t)mesh->n_vertices]);
        assert_true(fabs(total - 1.0) < 1e-10);
    }
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, 40, 1e-12, &pairs), 0);
    iso_heat_spectral(pairs, mesh, source, SOURCES, t_mm2, TIMES, heat);
    for (int c = 0; c < SOURCES * TIMES; c++) {
        double total = total_heat(m.mass, &heat[(size_t)c * (size_t)mesh->n_vertices]);
        assert_true(fabs(total - 1.0) < 1e-10);
    }
    iso_eigenpairs_free(pairs);
    iso_heat_direct_free(solver);
    free(heat);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

/* Heat does not jump to another piece of the mesh. */
static void pieces_stay_cold(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sheet(21, 11, 2.0);
    int32_t kept = 0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) { /* cut the sheet at x = 9 */
        double x = 0.0;
        for (int k = 0; k < 3; k++) {
            x += mesh->vertices_mm[mesh->triangles[t][k]].x / 3.0;
        }
        if (x < 8.0 || x > 10.0) {
            memmove(mesh->triangles[kept++], mesh->triangles[t], sizeof mesh->triangles[t]);
        }
    }
    mesh->n_triangles = kept;
    struct matrices m = matrices_of(mesh, ISO_MASS_LUMPED);
    struct iso_surface_point source = shape_locate(mesh, -3.3, 1.2);
    const double t_mm2 = 300.0;
    double *heat = column_room(mesh, 1);
    struct iso_heat_direct *solver = new_solver(&m, 0);
    assert_int_equal(
        iso_heat_direct(solver, mesh, m.stiffness, m.mass, &source, 1, &t_mm2, 1, heat), 0);
    double reached = 0.0;
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        if (mesh->vertices_mm[i].x > 9.0) {
            assert_true(heat[i] == 0.0);
        } else {
            reached = fmax(reached, heat[i]);
        }
    }
    assert_true(reached > 1e-4);
    iso_heat_direct_free(solver);
    free(heat);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

/* A large Krylov space and half of the spectrum both give the digits of the reference. */
static void both_ways_converge_to_the_reference(void **state)
{
    (void)state;
    enum { TIMES = 2 };
    const double t_mm2[TIMES] = {400.0, 250.0};
    struct iso_mesh *mesh = shape_relief(8.0);
    struct iso_surface_point source = shape_locate(mesh, 14.0, -9.0);
    for (int kind = 0; kind < 2; kind++) {
        struct matrices m = matrices_of(mesh, kind ? ISO_MASS_LUMPED : ISO_MASS_CONSISTENT);
        size_t n = (size_t)mesh->n_vertices;
        double *exact = column_room(mesh, TIMES), *heat = column_room(mesh, TIMES);
        reference_heat(mesh, &m, source, t_mm2, TIMES, exact);
        struct iso_heat_direct *solver = new_solver(&m, ISO_HEAT_KRYLOV_MAX);
        assert_int_equal(
            iso_heat_direct(solver, mesh, m.stiffness, m.mass, &source, 1, t_mm2, TIMES, heat), 0);
        double peak = 1.0 / (4.0 * M_PI * t_mm2[0]);
        for (size_t i = 0; i < TIMES * n; i++) {
            assert_true(fabs(heat[i] - exact[i]) < 1e-8 * peak);
        }
        struct iso_eigenpairs *pairs = NULL;
        int32_t k = mesh->n_vertices / 2;
        assert_int_equal(iso_eigenpairs_new(m.stiffness, m.mass, k, 1e-12, &pairs), 0);
        iso_heat_spectral(pairs, mesh, &source, 1, t_mm2, TIMES, heat);
        for (size_t i = 0; i < TIMES * n; i++) {
            assert_true(fabs(heat[i] - exact[i]) < 1e-6 * peak);
        }
        iso_eigenpairs_free(pairs);
        iso_heat_direct_free(solver);
        free(exact);
        free(heat);
        matrices_free(&m);
    }
    iso_mesh_free(mesh);
}

/* The mesh has fewer vertices than the Krylov space has dimensions, so that the space is complete.
 */
static void a_small_mesh_is_exhausted(void **state)
{
    (void)state;
    const double t_mm2[] = {0.5, 20.0};
    struct iso_mesh *mesh = shape_sheet(3, 2, 2.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    const struct iso_surface_point source = {1, {0.2, 0.5, 0.3}};
    struct iso_heat_direct *solver = new_solver(&m, ISO_HEAT_KRYLOV_MAX);
    double heat[12], exact[12];
    assert_int_equal(iso_heat_direct(solver, mesh, m.stiffness, m.mass, &source, 1, t_mm2, 2, heat),
                     0);
    reference_heat(mesh, &m, source, t_mm2, 2, exact);
    for (int i = 0; i < 12; i++) {
        assert_true(fabs(heat[i] - exact[i]) < 1e-9);
    }
    iso_heat_direct_free(solver);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

/* One call for several sources gives the same as one call for each source. Earlier calls for
 * another mesh make no difference. */
static void columns_do_not_depend_on_other_sources(void **state)
{
    (void)state;
    enum { SOURCES = 17 }; /* more than a block, and no multiple of what fits in a register */
    const double t_mm2 = 100.0;
    struct iso_mesh *mesh = shape_relief(6.0), *other = shape_relief(7.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct matrices m2 = matrices_of(other, ISO_MASS_CONSISTENT);
    struct iso_surface_point source[SOURCES];
    for (int s = 0; s < SOURCES; s++) {
        source[s] = shape_locate(mesh, 2.0 * s - 21.0, 30.0 - 4.0 * s);
    }
    size_t n = (size_t)mesh->n_vertices;
    double *all = column_room(mesh, SOURCES), *one = column_room(mesh, 1);
    double *elsewhere = column_room(other, 1);
    struct iso_heat_direct *solver = new_solver(&m, 0);
    assert_int_equal(
        iso_heat_direct(solver, mesh, m.stiffness, m.mass, source, SOURCES, &t_mm2, 1, all), 0);
    struct iso_surface_point place = shape_locate(other, 1.0, 2.0);
    for (int s = 0; s < SOURCES; s++) {
        assert_int_equal(
            iso_heat_direct(solver, other, m2.stiffness, m2.mass, &place, 1, &t_mm2, 1, elsewhere),
            0);
        assert_int_equal(
            iso_heat_direct(solver, mesh, m.stiffness, m.mass, &source[s], 1, &t_mm2, 1, one), 0);
        assert_memory_equal(one, &all[(size_t)s * n], n * sizeof *one);
    }
    iso_heat_direct_free(solver);
    free(all);
    free(one);
    free(elsewhere);
    matrices_free(&m);
    matrices_free(&m2);
    iso_mesh_free(mesh);
    iso_mesh_free(other);
}

static void impossible_options_are_refused(void **state)
{
    (void)state;
    const struct iso_heat_direct_options sane = {.n_capacity = 20, .nnz_capacity = 80};
    struct iso_heat_direct *solver = NULL;
    struct iso_heat_direct_options o;
#define REFUSED(field, bad) \
    o = sane;               \
    o.field = bad;          \
    assert_int_equal(iso_heat_direct_new(&o, &solver), -EINVAL)
    REFUSED(n_capacity, 0);
    REFUSED(nnz_capacity, 19);
    REFUSED(krylov, 1);
    REFUSED(krylov, -4);
    REFUSED(krylov, ISO_HEAT_KRYLOV_MAX + 1);
    REFUSED(gamma_over_t, -0.1);
    REFUSED(gamma_over_t, NAN);
    REFUSED(gamma_over_t, INFINITY);
#undef REFUSED
    assert_null(solver);
    iso_heat_direct_free(NULL);
}

static void impossible_requests_are_refused(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sheet(6, 5, 2.0), *larger = shape_sheet(7, 5, 2.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct matrices m2 = matrices_of(larger, ISO_MASS_CONSISTENT);
    struct iso_heat_direct *solver = new_solver(&m, 0);
    struct iso_surface_point source = shape_locate(mesh, 1.0, 1.5);
    double t = 20.0, heat[7 * 5];
    memset(heat, 0xab, sizeof heat);
    double untouched[7 * 5];
    memcpy(untouched, heat, sizeof heat);
#define HEAT(mesh_, m_, source_, n_sources, t_, n_times) \
    iso_heat_direct(solver, mesh_, m_.stiffness, m_.mass, source_, n_sources, t_, n_times, heat)
    assert_int_equal(HEAT(mesh, m, &source, 0, &t, 1), -EINVAL);
    assert_int_equal(HEAT(mesh, m, &source, 1, &t, 0), -EINVAL);
    assert_int_equal(HEAT(larger, m, &source, 1, &t, 1), -EINVAL);
    const double wrong[] = {0.0, -5.0, NAN, INFINITY};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_int_equal(HEAT(mesh, m, &source, 1, &wrong[i], 1), -EINVAL);
    }
    struct iso_surface_point nowhere = source;
    nowhere.triangle = mesh->n_triangles;
    assert_int_equal(HEAT(mesh, m, &nowhere, 1, &t, 1), -EINVAL);
    nowhere.triangle = -1;
    assert_int_equal(HEAT(mesh, m, &nowhere, 1, &t, 1), -EINVAL);
    struct iso_surface_point unknown = source;
    unknown.weight[1] = NAN;
    assert_int_equal(HEAT(mesh, m, &unknown, 1, &t, 1), -EINVAL);
    assert_int_equal(HEAT(larger, m2, &source, 1, &t, 1), -ENOSPC);
    double kept = m.stiffness->value[3];
    m.stiffness->value[3] = NAN;
    assert_int_equal(HEAT(mesh, m, &source, 1, &t, 1), -EDOM);
    m.stiffness->value[3] = -1e6; /* indefinite */
    assert_int_equal(HEAT(mesh, m, &source, 1, &t, 1), -EDOM);
    assert_memory_equal(heat, untouched, sizeof heat);
    m.stiffness->value[3] = kept; /* the solver still works after these errors */
    assert_int_equal(HEAT(mesh, m, &source, 1, &t, 1), 0);
    assert_true(fabs(total_heat(m.mass, heat) - 1.0) < 1e-10);
#undef HEAT
    iso_heat_direct_free(solver);
    matrices_free(&m);
    matrices_free(&m2);
    iso_mesh_free(mesh);
    iso_mesh_free(larger);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_ways_give_the_planar_kernel),
        cmocka_unit_test(a_sphere_has_its_legendre_series),
        cmocka_unit_test(total_heat_is_conserved),
        cmocka_unit_test(pieces_stay_cold),
        cmocka_unit_test(both_ways_converge_to_the_reference),
        cmocka_unit_test(a_small_mesh_is_exhausted),
        cmocka_unit_test(columns_do_not_depend_on_other_sources),
        cmocka_unit_test(impossible_options_are_refused),
        cmocka_unit_test(impossible_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
