/* The Laplacian of clouds of points, where it is known or that of a mesh of the same points. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/heat/intrinsic/cloud.h"
#include "core/heat/intrinsic/nearest.h"
#include "isotherm/shape.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

static double normal_number(void)
{
    const double u = 1.0 - drand48(), v = drand48();
    return sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v);
}

/* Points of a sphere of radius 1, all places being equally likely. */
static struct iso_vec3 *make_sphere(int32_t n)
{
    struct iso_vec3 *point = calloc((size_t)n, sizeof *point);
    assert_non_null(point);
    srand48(31);
    for (int32_t i = 0; i < n; i++) {
        point[i] = iso_unit(iso_vec3(normal_number(), normal_number(), normal_number()));
    }
    return point;
}

/* The worst relative error of the eigenvalues l (l + 1), each 2 l + 1 times, for l = 1..last. */
static double sphere_error(const struct iso_eigenpairs *pairs, int last)
{
    double most = 0.0;
    for (int l = 1, i = 1; l <= last; l++) {
        for (int m = -l; m <= l; m++, i++) {
            most = fmax(most, fabs(pairs->lambda[i] / (l * (l + 1.0)) - 1.0));
        }
    }
    return most;
}

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

static void random_points_of_a_sphere_have_its_harmonics(void **state)
{
    (void)state;
    const int32_t size[2] = {1500, 6000};
    const double bound[2] = {0.05, 0.015};
    for (int s = 0; s < 2; s++) {
        struct iso_vec3 *point = make_sphere(size[s]);
        struct iso_shape *shape = NULL;
        assert_int_equal(iso_shape_new_cloud(point, NULL, size[s], 0, 30, &shape), 0);
        print_message("%d points: eigenvalues off by %.2g, area by %.2g\n", size[s],
                      sphere_error(shape->pairs, 4), shape->total_area / (4.0 * M_PI) - 1.0);
        assert_true(shape->is_cloud);
        assert_int_equal(shape->mesh->n_vertices, size[s]);
        assert_true(sphere_error(shape->pairs, 4) < bound[s]);
        assert_near(shape->total_area, 4.0 * M_PI, 0.1 * bound[s] * 4.0 * M_PI);
        assert_true(least_conductance(shape->stiffness) > -1e-8);
        for (int32_t v = 0; v < size[s]; v++) {
            assert_int_equal(shape->near_boundary[v], 0);
            assert_true(shape->area[v] > 0.0);
        }
        iso_shape_free(shape);
        free(point);
    }
}

/* The mesh knows which points are neighbours on the surface, the cloud does not. */
static void a_cloud_has_the_spectrum_of_a_mesh_of_its_points(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sphere(4, 1.0);
    struct iso_shape *cloud = NULL, *robust = NULL;
    srand48(32);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const struct iso_vec3 p = mesh->vertices_mm[v];
        const struct iso_vec3 off = {drand48() - 0.5, drand48() - 0.5, drand48() - 0.5};
        const struct iso_vec3 moved = iso_unit(iso_madd(p, 0.03, off));
        mesh->vertices_mm[v] = iso_vec3(2.0 * moved.x, moved.y, 0.7 * moved.z);
    }
    assert_int_equal(iso_shape_new_robust(mesh, NULL, 40, &robust), 0);
    assert_int_equal(iso_shape_new_cloud(mesh->vertices_mm, NULL, mesh->n_vertices, 20, 40, &cloud),
                     0);
    double most = 0.0;
    for (int32_t i = 1; i < 40; i++) {
        most = fmax(most, fabs(cloud->pairs->lambda[i] / robust->pairs->lambda[i] - 1.0));
    }
    print_message("ellipsoid: eigenvalues off by %.2g from those of the mesh\n", most);
    assert_true(most < 0.01);
    assert_near(cloud->total_area, robust->total_area, 0.002 * robust->total_area);
    iso_shape_free(cloud);
    iso_shape_free(robust);
    iso_mesh_free(mesh);
}

enum { COLUMNS = 19, ROWS = 14 };

static bool is_on_edge(int32_t v)
{
    const int column = v % COLUMNS, row = v / COLUMNS;
    return column == 0 || column == COLUMNS - 1 || row == 0 || row == ROWS - 1;
}

static double entry(const struct iso_symmetric *a, int32_t i, int32_t j)
{
    const int32_t column = i < j ? i : j, row = i < j ? j : i;
    for (int32_t at = a->column_start[column]; at < a->column_start[column + 1]; at++) {
        if (a->row[at] == row) {
            return a->value[at];
        }
    }
    return 0.0;
}

static double difference_of(const struct iso_symmetric *a, const struct iso_symmetric *b)
{
    double most = 0.0;
    for (int32_t i = 0; i < a->n; i++) {
        for (int32_t j = 0; j <= i; j++) {
            most = fmax(most, fabs(entry(a, i, j) - entry(b, i, j)));
        }
    }
    return most;
}

/* In a plane all stars are parts of one Delaunay triangulation, which is unique, so that the
 * matrices are those of the sheet. */
static void in_a_plane_all_stars_agree(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sheet(COLUMNS, ROWS, 1.0), *cloud = NULL;
    srand48(33);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        if (!is_on_edge(v)) {
            mesh->vertices_mm[v].x += 0.5 * (drand48() - 0.5);
            mesh->vertices_mm[v].y += 0.5 * (drand48() - 0.5);
        }
    }
    assert_int_equal(iso_cloud_triangulate(mesh->vertices_mm, mesh->n_vertices, 24, &cloud), 0);
    assert_int_equal(cloud->n_triangles, 3 * mesh->n_triangles);
    struct matrices robust = matrices_of(mesh, ISO_MASS_CONSISTENT), stars = {NULL, NULL};
    const int32_t nnz = cloud->n_vertices + 3 * cloud->n_triangles;
    assert_int_equal(iso_symmetric_new(cloud->n_vertices, nnz, &stars.stiffness), 0);
    assert_int_equal(iso_symmetric_new(cloud->n_vertices, nnz, &stars.mass), 0);
    for (int kind = ISO_MASS_CONSISTENT; kind <= ISO_MASS_LUMPED; kind++) {
        assert_int_equal(iso_stiffness_mass_robust(mesh, (enum iso_mass)kind, NULL,
                                                   robust.stiffness, robust.mass),
                         0);
        assert_int_equal(
            iso_stiffness_mass_cloud(cloud, (enum iso_mass)kind, NULL, stars.stiffness, stars.mass),
            0);
        assert_near(difference_of(stars.stiffness, robust.stiffness), 0.0, 1e-9);
        assert_near(difference_of(stars.mass, robust.mass), 0.0, 1e-9);
    }
    matrices_free(&robust);
    matrices_free(&stars);
    iso_mesh_free(cloud);
    iso_mesh_free(mesh);
}

/* Every square of a lattice is a circle with four points. Its eigenvalues are known:
 * (m pi / WIDE)^2 + (n pi / HIGH)^2. A twin of each point does not matter. */
static void a_lattice_has_one_triangulation(void **state)
{
    (void)state;
    enum { N = COLUMNS * ROWS };
    struct iso_mesh *mesh = shape_sheet(COLUMNS, ROWS, 1.0), *cloud = NULL;
    struct iso_vec3 twice[2 * N];
    uint8_t open[2 * N];
    assert_int_equal(mesh->n_vertices, N);
    for (int32_t v = 0; v < N; v++) {
        twice[v] = twice[2 * N - 1 - v] = mesh->vertices_mm[v];
    }
    assert_int_equal(iso_cloud_triangulate(twice, 2 * N, 0, &cloud), 0);
    assert_int_equal(cloud->n_triangles, 3 * mesh->n_triangles);
    iso_cloud_boundary(cloud, open);
    for (int32_t v = 0; v < 2 * N; v++) {
        assert_int_equal(open[v], v >= N || is_on_edge(v));
    }
    assert_int_equal(iso_cloud_merge(cloud), 0);
    assert_int_equal(cloud->n_triangles, mesh->n_triangles);
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_shape_new_cloud(twice, NULL, 2 * N, 0, 8, &shape), 0);
    assert_int_equal(shape->mesh->n_vertices, N);
    assert_int_equal(shape->mesh->n_triangles, mesh->n_triangles);
    assert_near(shape->total_area, (COLUMNS - 1.0) * (ROWS - 1.0), 1e-9);
    const double w = M_PI / (COLUMNS - 1), h = M_PI / (ROWS - 1);
    const double expected[4] = {w * w, h * h, w * w + h * h, 4.0 * w * w};
    for (int i = 0; i < 4; i++) {
        assert_near(shape->pairs->lambda[i + 1] / expected[i], 1.0, 0.02);
    }
    iso_shape_free(shape);
    iso_mesh_free(cloud);
    iso_mesh_free(mesh);
}

static void a_constant_density_changes_nothing(void **state)
{
    (void)state;
    enum { N = 400 };
    struct iso_vec3 *point = make_sphere(N);
    struct iso_colour colour[N];
    struct iso_shape *shape = NULL;
    for (int i = 0; i < N; i++) {
        colour[i] = (struct iso_colour){{1.0f, 1.0f, 0.5f}};
    }
    assert_int_equal(iso_shape_new_cloud(point, colour, N, 0, 20, &shape), 0);
    for (int i = 1; i < 20; i++) {
        for (int c = 0; c < ISO_CHANNELS; c++) {
            assert_near(shape->weighted[c]->lambda[i] / shape->pairs->lambda[i], 1.0, 1e-9);
        }
    }
    iso_shape_free(shape);
    free(point);
}

/* Points of which many share a coordinate, against a search through all of them. */
static void the_nearest_points_are_found(void **state)
{
    (void)state;
    enum { N = 700, K = 9, HALF = N / 2 };
    struct iso_vec3 point[N];
    struct iso_nearest tree;
    struct iso_neighbour found[N];
    int32_t number[N];
    srand48(34);
    for (int32_t i = 0; i < N; i++) {
        const double x = floor(6.0 * drand48()), y = 10.0 * drand48();
        point[i] = iso_vec3(x, y, i % 2 ? 0.0 : drand48());
        number[i] = N - 1 - i;
    }
    assert_int_equal(iso_nearest_init(&tree, point, number, HALF), 0); /* HALF..N - 1 */
    for (int32_t i = HALF; i < N; i++) {
        assert_int_equal(iso_nearest_find(&tree, i, K, found), K);
        for (int k = 0; k < K; k++) {
            int before = 0;
            const struct iso_vec3 off = iso_sub(point[found[k].point], point[i]);
            assert_true(found[k].point >= HALF && found[k].point != i);
            assert_near(found[k].square, iso_dot(off, off), 0.0);
            for (int32_t j = HALF; j < N; j++) {
                const struct iso_vec3 other = iso_sub(point[j], point[i]);
                const double square = iso_dot(other, other);
                before += j != i && (square < found[k].square ||
                                     (square <= found[k].square && j < found[k].point));
            }
            assert_int_equal(before, k);
        }
    }
    assert_int_equal(iso_nearest_find(&tree, N - 1, N, found), HALF - 1);
    iso_nearest_done(&tree);
}

static void refuses_what_is_no_surface(void **state)
{
    (void)state;
    enum { N = 60 };
    struct iso_vec3 *point = make_sphere(N);
    struct iso_mesh *mesh = NULL;
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_cloud_triangulate(point, 0, 0, &mesh), -EINVAL);
    assert_int_equal(iso_cloud_triangulate(point, N, ISO_CLOUD_NEIGHBOURS_MIN - 1, &mesh), -EINVAL);
    assert_int_equal(iso_cloud_triangulate(point, N, ISO_CLOUD_NEIGHBOURS_MAX + 1, &mesh), -EINVAL);
    assert_int_equal(iso_cloud_triangulate(point, 1, 0, &mesh), 0);
    assert_int_equal(mesh->n_triangles, 0);
    iso_mesh_free(mesh);
    mesh = NULL;
    assert_int_equal(iso_shape_new_cloud(point, NULL, 20, 0, 0, &shape), -ENODATA);
    point[7].y = INFINITY;
    assert_int_equal(iso_cloud_triangulate(point, N, 0, &mesh), -EINVAL);
    assert_int_equal(iso_shape_new_cloud(point, NULL, N, 0, 0, &shape), -EINVAL);
    for (int i = 0; i < N; i++) {
        point[i] = iso_vec3(i, 2.0 * i, -i);
    }
    assert_int_equal(iso_shape_new_cloud(point, NULL, N, 0, 0, &shape), -ENODATA);
    assert_null(mesh);
    assert_null(shape);
    free(point);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_points_of_a_sphere_have_its_harmonics),
        cmocka_unit_test(a_cloud_has_the_spectrum_of_a_mesh_of_its_points),
        cmocka_unit_test(in_a_plane_all_stars_agree),
        cmocka_unit_test(a_lattice_has_one_triangulation),
        cmocka_unit_test(a_constant_density_changes_nothing),
        cmocka_unit_test(the_nearest_points_are_found),
        cmocka_unit_test(refuses_what_is_no_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
