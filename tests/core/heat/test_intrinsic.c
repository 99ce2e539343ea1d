/* The robust Laplacian: where it is the plain one or that of another mesh, and where it is known.
 */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/heat/intrinsic/intrinsic.h"
#include "isotherm/eigenpairs.h"
#include "isotherm/shape.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

static struct matrices robust_of(const struct iso_mesh *mesh, enum iso_mass kind,
                                 const double *density)
{
    struct matrices m = {0};
    const int32_t nnz = mesh->n_vertices + 3 * mesh->n_triangles;
    assert_int_equal(iso_symmetric_new(mesh->n_vertices, nnz, &m.stiffness), 0);
    assert_int_equal(iso_symmetric_new(mesh->n_vertices, nnz, &m.mass), 0);
    assert_int_equal(iso_stiffness_mass_robust(mesh, kind, density, m.stiffness, m.mass), 0);
    return m;
}

/* Entries that one of them does not store are 0 in it. */
static double difference_of(const struct iso_symmetric *a, const struct iso_symmetric *b)
{
    const size_t n = (size_t)a->n;
    double *dense = calloc(n * n, sizeof *dense), most = 0.0;
    assert_true(dense && a->n == b->n);
    for (int side = 0; side < 2; side++) {
        const struct iso_symmetric *m = side ? b : a;
        for (int32_t j = 0; j < m->n; j++) {
            for (int32_t at = m->column_start[j]; at < m->column_start[j + 1]; at++) {
                dense[(size_t)m->row[at] * n + (size_t)j] += side ? -m->value[at] : m->value[at];
            }
        }
    }
    for (size_t i = 0; i < n * n; i++) {
        most = fmax(most, fabs(dense[i]));
    }
    free(dense);
    return most;
}

/* The most negative conductance between two vertices. */
static double least_conductance(const struct iso_symmetric *stiffness)
{
    double least = 0.0;
    for (int32_t j = 0; j < stiffness->n; j++) {
        const int32_t end = stiffness->column_start[j + 1];
        for (int32_t at = stiffness->column_start[j] + 1; at < end; at++) {
            least = fmin(least, -stiffness->value[at]);
        }
    }
    return least;
}

static void add_triangle(struct iso_mesh *mesh, int32_t a, int32_t b, int32_t c)
{
    const int32_t corner[3] = {a, b, c};
    assert_int_equal(iso_mesh_reserve(mesh, mesh->n_vertices, mesh->n_triangles + 1), 0);
    memcpy(mesh->triangles[mesh->n_triangles++], corner, sizeof corner);
}

static int32_t add_vertex(struct iso_mesh *mesh, struct iso_vec3 at)
{
    assert_int_equal(iso_mesh_reserve(mesh, mesh->n_vertices + 1, mesh->n_triangles), 0);
    mesh->vertices_mm[mesh->n_vertices] = at;
    return mesh->n_vertices++;
}

/* All triangles of this sphere are acute, so its edges are Delaunay. Some triangles are turned
 * inside out, which the plain matrices do not notice either. */
static void a_delaunay_mesh_keeps_its_matrices(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sphere(3, 20.0);
    double *density = calloc((size_t)mesh->n_vertices, sizeof *density);
    assert_non_null(density);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        density[v] = 1.0 + 0.02 * mesh->vertices_mm[v].x;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t += 3) {
        const int32_t first = mesh->triangles[t][0];
        mesh->triangles[t][0] = mesh->triangles[t][1];
        mesh->triangles[t][1] = first;
    }
    for (int kind = ISO_MASS_CONSISTENT; kind <= ISO_MASS_LUMPED; kind++) {
        struct matrices plain = matrices_of(mesh, (enum iso_mass)kind);
        struct matrices robust = robust_of(mesh, (enum iso_mass)kind, NULL);
        assert_near(difference_of(robust.stiffness, plain.stiffness), 0.0, 1e-12);
        assert_near(difference_of(robust.mass, plain.mass), 0.0, 1e-12);
        assert_int_equal(iso_stiffness_mass_weighted(mesh, (enum iso_mass)kind, density,
                                                     plain.stiffness, plain.mass),
                         0);
        matrices_free(&robust);
        robust = robust_of(mesh, (enum iso_mass)kind, density);
        assert_near(difference_of(robust.stiffness, plain.stiffness), 0.0, 1e-12);
        assert_near(difference_of(robust.mass, plain.mass), 0.0, 1e-12);
        matrices_free(&robust);
        matrices_free(&plain);
    }
    free(density);
    iso_mesh_free(mesh);
}

/* Twice the signed area of a triangle of a sheet in the plane z = 0. */
static double turn(const struct iso_mesh *mesh, int32_t a, int32_t b, int32_t c)
{
    const struct iso_vec3 *p = mesh->vertices_mm;
    return (p[b].x - p[a].x) * (p[c].y - p[a].y) - (p[c].x - p[a].x) * (p[b].y - p[a].y);
}

/* Exchanges the diagonals of many convex quadrilaterals of a flat sheet. The surface stays, but its
 * triangles become slivers. */
static int spoil_sheet(struct iso_mesh *mesh)
{
    const int32_t n = mesh->n_triangles;
    int32_t(*adjacent)[3] = calloc((size_t)n, sizeof *adjacent);
    int flips = 0;
    assert_non_null(adjacent);
    for (int round = 0; round < 6; round++) {
        uint8_t touched[4096] = {0};
        assert_true(n <= 4096);
        assert_int_equal(iso_mesh_adjacency(mesh, adjacent), 0);
        for (int32_t t = 0; t < n; t++) {
            const int k = (int)(drand48() * 3.0);
            const int32_t u = adjacent[t][k], *v = mesh->triangles[t];
            if (u < 0 || touched[t] || touched[u]) {
                continue;
            }
            const int32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3], *w = mesh->triangles[u];
            const int32_t d = w[0] + w[1] + w[2] - b - c;
            if (turn(mesh, a, b, d) > 0.02 && turn(mesh, a, d, c) > 0.02) {
                const int32_t first[3] = {a, b, d}, second[3] = {a, d, c};
                memcpy(mesh->triangles[t], first, sizeof first);
                memcpy(mesh->triangles[u], second, sizeof second);
                touched[t] = touched[u] = 1;
                flips++;
            }
        }
    }
    free(adjacent);
    return flips;
}

/* The Delaunay triangulation of points in general position is unique, so that it does not matter
 * from which triangulation of the same flat surface it is made. */
static void the_triangulation_of_a_flat_surface_does_not_matter(void **state)
{
    (void)state;
    enum { COLUMNS = 19, ROWS = 14 };
    struct iso_mesh *mesh = shape_sheet(COLUMNS, ROWS, 1.0);
    srand48(20);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const int column = v % COLUMNS, row = v / COLUMNS;
        if (column > 0 && column < COLUMNS - 1 && row > 0 && row < ROWS - 1) {
            mesh->vertices_mm[v].x += 0.5 * (drand48() - 0.5);
            mesh->vertices_mm[v].y += 0.5 * (drand48() - 0.5);
        }
    }
    struct matrices good = robust_of(mesh, ISO_MASS_CONSISTENT, NULL);
    const int flips = spoil_sheet(mesh);
    struct matrices plain = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct matrices bad = robust_of(mesh, ISO_MASS_CONSISTENT, NULL);
    print_message("sheet: %d edges flipped; least conductance %.3g, robust %.3g\n", flips,
                  least_conductance(plain.stiffness), least_conductance(bad.stiffness));
    assert_true(least_conductance(plain.stiffness) < -0.5);
    assert_true(least_conductance(bad.stiffness) > -1e-8);
    assert_true(difference_of(plain.stiffness, good.stiffness) > 0.5);
    assert_near(difference_of(bad.stiffness, good.stiffness), 0.0, 1e-8);
    assert_near(difference_of(bad.mass, good.mass), 0.0, 1e-8);
    matrices_free(&good);
    matrices_free(&plain);
    matrices_free(&bad);
    iso_mesh_free(mesh);
}

/* Makes a good mesh bad without changing its surface. Some triangles get a vertex close to one of
 * their edges, which makes a cap and slivers. Of some pairs of triangles one gets a vertex on the
 * common edge and the other does not; a triangle without area closes the crack. */
static void spoil_sphere(struct iso_mesh *mesh)
{
    const int32_t n = mesh->n_triangles;
    for (int32_t t = 0; t < n; t += 2) {
        const int32_t a = mesh->triangles[t][0], b = mesh->triangles[t][1],
                      c = mesh->triangles[t][2];
        const struct iso_vec3 *p = mesh->vertices_mm;
        const double w = t % 4 ? 0.5 : 0.3 + 0.4 * drand48(), off = t % 4 ? 0.0 : 0.01;
        struct iso_vec3 at = iso_scale((1.0 - off) * w, p[a]);
        at = iso_madd(iso_madd(at, (1.0 - off) * (1.0 - w), p[b]), off, p[c]);
        const int32_t m = add_vertex(mesh, at);
        mesh->triangles[t][1] = m; /* (a, m, c) */
        add_triangle(mesh, m, b, c);
        add_triangle(mesh, a, b, m); /* a cap, or without area */
    }
}

/* The worst relative error of the eigenvalues l (l + 1) / R^2, each 2 l + 1 times, for l = 1..4. */
static double sphere_error(const struct iso_eigenpairs *pairs, double radius)
{
    double most = 0.0;
    for (int l = 1, i = 1; l <= 4; l++) {
        for (int m = -l; m <= l; m++, i++) {
            const double expected = l * (l + 1) / (radius * radius);
            most = fmax(most, fabs(pairs->lambda[i] / expected - 1.0));
        }
    }
    return most;
}

static void a_bad_sphere_has_its_harmonics(void **state)
{
    (void)state;
    const double radius = 20.0;
    struct iso_mesh *mesh = shape_sphere(4, radius);
    struct iso_shape *plain = NULL, *robust = NULL;
    srand48(21);
    spoil_sphere(mesh);
    assert_int_equal(iso_shape_new(mesh, NULL, 25, &plain), 0);
    assert_int_equal(iso_shape_new_robust(mesh, NULL, 25, &robust), 0);
    print_message("bad sphere: off by %.2g, plain by %.2g; least conductance %.2g, plain %.2g\n",
                  sphere_error(robust->pairs, radius), sphere_error(plain->pairs, radius),
                  least_conductance(robust->stiffness), least_conductance(plain->stiffness));
    assert_true(sphere_error(robust->pairs, radius) < 0.015);
    assert_true(sphere_error(plain->pairs, radius) > 3.0 * sphere_error(robust->pairs, radius));
    assert_true(least_conductance(robust->stiffness) > -1e-8);
    assert_true(least_conductance(plain->stiffness) < -1.0);
    /* All triangles without area are in the robust shape, none is in the plain one. */
    assert_int_equal(robust->mesh->n_triangles, mesh->n_triangles);
    assert_true(plain->mesh->n_triangles < mesh->n_triangles);
    iso_shape_free(plain);
    iso_shape_free(robust);
    iso_mesh_free(mesh);
}

static int ascending(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* Three pages of WIDE x HIGH that meet at one spine. Along the spine the eigenfunctions are waves
 * with m half periods. Across it they are cos(n pi x / WIDE), the same in all pages, or
 * sin((n + 1/2) pi x / WIDE) with amplitudes of sum 0, twice. */
static void a_book_of_three_pages_has_its_waves(void **state)
{
    (void)state;
    enum { PAGES = 3, WIDE = 32, HIGH = 46, K = 20, MODES = 6 };
    struct iso_mesh *mesh = NULL;
    double expected[3 * MODES * MODES];
    int n = 0;
    assert_int_equal(iso_mesh_new(HIGH + 1, 1, &mesh), 0);
    for (int row = 0; row <= HIGH; row++) {
        (void)add_vertex(mesh, iso_vec3(0.0, row, 0.0));
    }
    for (int page = 0; page < PAGES; page++) {
        const double angle = 0.4 + 1.9 * page; /* not in the order of a rotation by equal angles */
        int32_t before[HIGH + 1], now[HIGH + 1];
        for (int row = 0; row <= HIGH; row++) {
            before[row] = row;
        }
        for (int column = 1; column <= WIDE; column++) {
            for (int row = 0; row <= HIGH; row++) {
                now[row] = add_vertex(mesh,
                                      iso_vec3(column * cos(angle), row, column * sin(angle)));
            }
            for (int row = 0; row < HIGH; row++) {
                add_triangle(mesh, before[row], now[row], now[row + 1]);
                add_triangle(mesh, before[row], before[row + 1], now[row + 1]);
            }
            memcpy(before, now, sizeof now);
        }
    }
    for (int m = 0; m < MODES; m++) {
        for (int half = 0; half < MODES; half++) { /* half = 2 n, or 2 n + 1: twice */
            const double across = half * M_PI / (2.0 * WIDE), along = m * M_PI / HIGH;
            for (int copy = 0; copy <= half % 2; copy++) {
                expected[n++] = across * across + along * along;
            }
        }
    }
    qsort(expected, (size_t)n, sizeof *expected, ascending);
    struct matrices matrices = robust_of(mesh, ISO_MASS_CONSISTENT, NULL);
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(matrices.stiffness, matrices.mass, K, 0.0, &pairs), 0);
    assert_near(pairs->lambda[0], 0.0, 1e-10);
    for (int i = 1; i < K; i++) {
        assert_near(pairs->lambda[i] / expected[i], 1.0, 0.01);
    }
    iso_eigenpairs_free(pairs);
    matrices_free(&matrices);
    iso_mesh_free(mesh);
}

/* Around an edge of many triangles each side is joined to the one that faces it: six pages make six
 * wedges, and going around a wedge by two steps comes to the next page, whatever the numbering. */
static void sides_that_face_each_other_are_joined(void **state)
{
    (void)state;
    enum { PAGES = 6 };
    static const int order[PAGES] = {3, 0, 5, 1, 4, 2}; /* page i is at order[i] sixths of a turn */
    struct iso_mesh *mesh = NULL;
    struct iso_intrinsic cover;
    assert_int_equal(iso_mesh_new(2, 1, &mesh), 0);
    (void)add_vertex(mesh, iso_vec3(1, 1, 0));
    (void)add_vertex(mesh, iso_vec3(1, 1, 3));
    for (int page = 0; page < PAGES; page++) {
        const double angle = order[page] * M_PI / 3.0;
        const int32_t tip = add_vertex(mesh, iso_vec3(1 + cos(angle), 1 + sin(angle), 1));
        add_triangle(mesh, page % 2, 1 - page % 2, tip);
    }
    assert_int_equal(iso_intrinsic_cover(mesh, &cover), 0);
    assert_int_equal(cover.n_triangles, 2 * PAGES);
    for (int32_t side = 0; side < cover.n_sides; side++) {
        const int32_t other = cover.across[side];
        assert_int_equal(cover.across[other], side);
        assert_int_equal(cover.corner[iso_side_next(other)], cover.corner[side]);
        assert_int_equal(cover.corner[iso_side_next(side)], cover.corner[other]);
        if (cover.corner[side] == 0 && cover.corner[other] == 1) { /* up the spine */
            const int page = side / 6, next = other / 6;
            assert_int_equal(order[next], (order[page] + 1) % PAGES);
        }
    }
    iso_intrinsic_done(&cover);
    iso_mesh_free(mesh);
}

/* The edge A B, opposite to the obtuse corner C, is flipped and then joins C to itself. Unfolded at
 * A B, the two sides of the triangle become the triangles A C C' and B C' C; C' is (1, -1). */
static void an_obtuse_corner_meets_itself(void **state)
{
    (void)state;
    const double sixths[9] = {3, 0, -3, 0, 1, -1, -3, -1, 4}; /* of L */
    const double twelfths[9] = {1, 0, 1, 0, 3, 3, 1, 3, 12};  /* of B */
    const struct iso_vec3 at[3] = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}};
    struct iso_mesh *mesh = shape_sheet(2, 2, 1.0);
    memcpy(mesh->vertices_mm, at, sizeof at);
    mesh->n_vertices = 3, mesh->n_triangles = 0;
    add_triangle(mesh, 0, 1, 2);
    struct matrices m = robust_of(mesh, ISO_MASS_CONSISTENT, NULL);
    for (int i = 0; i < 9; i++) {
        double x[3] = {0}, y[3] = {0};
        x[i / 3] = y[i % 3] = 1.0;
        assert_near(matrices_form(m.stiffness, x, y), sixths[i] / 6.0, 1e-14);
        assert_near(matrices_form(m.mass, x, y), twelfths[i] / 12.0, 1e-14);
    }
    matrices_free(&m);
    iso_mesh_free(mesh);
}

static void impossible_requests_are_refused(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sphere(0, 1.0), *point = shape_sphere(0, 1.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_LUMPED);
    struct iso_symmetric *small = NULL;
    double density[12] = {0.0};
    assert_int_equal(iso_symmetric_new(12, 12, &small), 0);
    assert_int_equal(iso_stiffness_mass_robust(mesh, ISO_MASS_LUMPED, NULL, small, m.mass),
                     -ENOSPC);
    assert_int_equal(iso_stiffness_mass_robust(mesh, ISO_MASS_LUMPED, NULL, m.stiffness, small),
                     -ENOSPC);
    assert_int_equal(iso_stiffness_mass_robust(mesh, ISO_MASS_LUMPED, density, m.stiffness, m.mass),
                     -EINVAL);
    for (int32_t v = 0; v < point->n_vertices; v++) {
        point->vertices_mm[v] = iso_vec3(1, 2, 3);
    }
    assert_int_equal(iso_stiffness_mass_robust(point, ISO_MASS_LUMPED, NULL, m.stiffness, m.mass),
                     -EINVAL);
    point->n_triangles = 0;
    assert_int_equal(iso_stiffness_mass_robust(point, ISO_MASS_LUMPED, NULL, m.stiffness, m.mass),
                     -EINVAL);
    iso_symmetric_free(small);
    matrices_free(&m);
    iso_mesh_free(mesh);
    iso_mesh_free(point);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_delaunay_mesh_keeps_its_matrices),
        cmocka_unit_test(the_triangulation_of_a_flat_surface_does_not_matter),
        cmocka_unit_test(a_bad_sphere_has_its_harmonics),
        cmocka_unit_test(a_book_of_three_pages_has_its_waves),
        cmocka_unit_test(sides_that_face_each_other_are_joined),
        cmocka_unit_test(an_obtuse_corner_meets_itself),
        cmocka_unit_test(impossible_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
