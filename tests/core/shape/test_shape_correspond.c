/* Geodesic distances in heat, and functional maps, on surfaces whose answers are known. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isotherm/correspondence.h"
#include "isotherm/signature.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

static struct iso_shape *prepare(const struct iso_mesh *mesh, int32_t n_pairs)
{
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_shape_new(mesh, NULL, n_pairs, &shape), 0);
    return shape;
}

static double *distances(const struct iso_shape *shape, int32_t source)
{
    struct iso_geodesic *geodesic = NULL;
    double *out = calloc((size_t)shape->mesh->n_vertices, sizeof *out);
    assert_non_null(out);
    assert_int_equal(iso_geodesic_new(shape, &geodesic), 0);
    assert_int_equal(iso_geodesic_distance(geodesic, source, out), 0);
    assert_int_equal(iso_geodesic_distance(geodesic, shape->mesh->n_vertices, out), -EINVAL);
    iso_geodesic_free(geodesic);
    return out;
}

/* Great circles. */
static void a_sphere_has_great_circles(void **state)
{
    const double radius = 15.0;
    struct iso_mesh *mesh = shape_sphere(4, radius);
    struct iso_shape *shape = prepare(mesh, 10);
    const int32_t source = 77;
    double *d = distances(shape, source), mean = 0.0, most = 0.0;
    (void)state;
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const double cosine = iso_dot(mesh->vertices_mm[v], mesh->vertices_mm[source]) /
                              (radius * radius);
        const double off = fabs(d[v] - radius * acos(fmax(-1.0, fmin(1.0, cosine))));
        mean += off / mesh->n_vertices;
        most = fmax(most, off);
    }
    print_message("geodesics of a sphere: off by %.3f %% of a half circle in the mean, %.3f %% at "
                  "most\n",
                  100.0 * mean / (M_PI * radius), 100.0 * most / (M_PI * radius));
    assert_true(mean < 0.01 * M_PI * radius);
    assert_true(most < 0.04 * M_PI * radius);
    assert_near(d[source], 0.0, 1e-12);
    free(d);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

/* The sheet on a cylinder has the distances of the flat sheet, which are straight lines. */
static void a_rolled_sheet_keeps_straight_lines(void **state)
{
    struct iso_mesh *mesh = shape_sheet(41, 31, 1.0);
    struct iso_vec3 *flat = calloc((size_t)mesh->n_vertices, sizeof *flat);
    const int32_t source = 12 * 41 + 9;
    (void)state;
    assert_non_null(flat);
    memcpy(flat, mesh->vertices_mm, (size_t)mesh->n_vertices * sizeof *flat);
    shape_roll(mesh, 12.0);
    struct iso_shape *shape = prepare(mesh, 10);
    double *d = distances(shape, source), mean = 0.0, most = 0.0;
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const double off = fabs(d[v] - iso_norm(iso_sub(flat[v], flat[source])));
        mean += off / mesh->n_vertices;
        most = fmax(most, off);
    }
    print_message("geodesics of a rolled sheet: off by %.3f edges in the mean, %.3f at most\n",
                  mean, most);
    assert_true(mean < 0.5 && most < 1.5);
    free(d);
    free(flat);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

/* An ellipsoid of three different axes, a little bent, so that it has no symmetry. */
static struct iso_mesh *lump(int splits)
{
    struct iso_mesh *mesh = shape_sphere(splits, 10.0);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const struct iso_vec3 p = mesh->vertices_mm[v];
        mesh->vertices_mm[v] = iso_vec3(1.9 * p.x + 0.04 * p.y * p.y, p.y + 0.05 * p.x * p.z,
                                        0.7 * p.z * (1.0 + 0.03 * p.x) + 0.02 * p.y * p.x);
    }
    return mesh;
}

/* The same surface with its vertices in another order. */
static struct iso_mesh *shuffled(const struct iso_mesh *mesh, int32_t *old)
{
    const int32_t n = mesh->n_vertices;
    struct iso_mesh *out = NULL;
    int32_t *now = calloc((size_t)n, sizeof *now);
    assert_non_null(now);
    assert_int_equal(iso_mesh_new(n, mesh->n_triangles, &out), 0);
    for (int32_t v = 0; v < n; v++) {
        old[v] = (int32_t)(((int64_t)v * 101 + 7) % n); /* 101 has no divisor with n in common */
        now[old[v]] = v;
        out->vertices_mm[v] = mesh->vertices_mm[old[v]];
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            out->triangles[t][k] = now[mesh->triangles[t][k]];
        }
    }
    out->n_vertices = n;
    out->n_triangles = mesh->n_triangles;
    free(now);
    return out;
}

/* Functions of the points themselves, so that a wave signature's weaknesses play no part. */
static void places(const struct iso_mesh *mesh, double *out)
{
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const struct iso_vec3 p = mesh->vertices_mm[v];
        const double values[] = {p.x,
                                 p.y,
                                 p.z,
                                 p.x * p.y,
                                 p.y * p.z,
                                 p.z * p.x,
                                 p.x * p.x,
                                 exp(0.1 * p.x),
                                 sin(0.3 * p.y),
                                 cos(0.4 * p.z)};
        memcpy(&out[10 * v], values, sizeof values);
    }
}

static void a_shuffled_shape_is_put_in_order(void **state)
{
    enum { K = 15, N = 10 };
    struct iso_mesh *mesh = lump(3);
    const size_t n = (size_t)mesh->n_vertices;
    int32_t *old = calloc(n, sizeof *old), *point = calloc(n, sizeof *point);
    double *from = calloc(2 * n * N, sizeof *from), c[K * K], back[K * K];
    assert_true(old && point && from);
    struct iso_mesh *other = shuffled(mesh, old);
    struct iso_shape *a = prepare(mesh, 60), *b = prepare(other, 60);
    (void)state;
    places(mesh, from);
    places(other, from + n * N);
    const struct iso_shared_functions functions = {N, from, from + n * N};
    assert_int_equal(iso_functional_map_fit(a, b, K, &functions, 1e-3, c), 0);
    assert_int_equal(iso_zoom_out(a, b, K, c, 5, 60, point), 0);
    size_t right = 0;
    for (size_t v = 0; v < n; v++) {
        right += point[v] == old[v];
    }
    print_message("%zu of %zu vertices found again\n", right, n);
    assert_int_equal(right, n);
    /* The map of true points is orthogonal, and +-1 where eigenvalues are simple. */
    assert_int_equal(iso_functional_map_of(a, b, K, old, back), 0);
    for (int i = 0; i < K; i++) {
        for (int j = 0; j < K; j++) {
            assert_near(fabs(back[i * K + j]), i == j ? 1.0 : 0.0, 1e-5);
        }
    }
    point[3] = (int32_t)n;
    assert_int_equal(iso_functional_map_of(a, b, K, point, back), -EINVAL);
    assert_int_equal(iso_functional_map_fit(a, b, 61, &functions, 1e-3, c), -EINVAL);
    assert_int_equal(iso_functional_map_fit(a, b, K, &functions, 0.0, c), -EINVAL);
    assert_int_equal(iso_zoom_out(a, b, K, c, 0, 60, point), -EINVAL);
    assert_int_equal(iso_zoom_out(a, b, K, c, 5, K - 1, point), -EINVAL);
    iso_shape_free(a);
    iso_shape_free(b);
    iso_mesh_free(mesh);
    iso_mesh_free(other);
    free(old);
    free(point);
    free(from);
}

/* A long body with four limbs of different lengths, which signatures cannot take for its mirror
 * image. */
static struct iso_mesh *limbs(int splits)
{
    static const struct {
        struct iso_vec3 at;
        double length;
    } limb[4] = {{{1.0, 0.4, 0.1}, 0.9},
                 {{-1.0, 0.2, 0.5}, 0.5},
                 {{0.1, -1.0, 0.4}, 0.7},
                 {{0.2, 0.9, -0.9}, 1.2}};
    struct iso_mesh *mesh = shape_sphere(splits, 10.0);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const struct iso_vec3 p = mesh->vertices_mm[v];
        double grown = 1.0;
        for (int i = 0; i < 4; i++) {
            const double cosine = iso_dot(iso_unit(p), iso_unit(limb[i].at));
            const double angle = acos(fmax(-1.0, fmin(1.0, cosine))) / 0.35;
            grown += limb[i].length * exp(-angle * angle);
        }
        mesh->vertices_mm[v] = iso_vec3(2.0 * grown * p.x, 0.6 * grown * p.y, 0.6 * grown * p.z);
    }
    return mesh;
}

/* The whole way from signatures, which know nothing of the order of vertices. */
static void signatures_match_a_shuffled_shape(void **state)
{
    enum { K = 50 };
    struct iso_mesh *mesh = limbs(3);
    const size_t n = (size_t)mesh->n_vertices;
    int32_t *old = calloc(n, sizeof *old), *point = calloc(n, sizeof *point);
    double *c = calloc((size_t)K * K, sizeof *c), *again = calloc((size_t)K * K, sizeof *again);
    assert_true(old && point && c && again);
    struct iso_mesh *other = shuffled(mesh, old);
    /* The smaller number of pairs counts. */
    struct iso_shape *a = prepare(mesh, 60), *b = prepare(other, K), *few = prepare(mesh, 2);
    struct iso_match_options options = {.first_pairs = 20, .step = 5, .weight = 0.01};
    (void)state;
    assert_int_equal(iso_shape_match(a, b, &options, point, c), 0);
    size_t right = 0;
    for (size_t v = 0; v < n; v++) {
        right += point[v] == old[v];
    }
    print_message("%zu of %zu vertices matched by signatures\n", right, n);
    assert_true(right > n - n / 20);
    assert_int_equal(iso_functional_map_of(a, b, K, point, again), 0);
    assert_memory_equal(c, again, (size_t)K * K * sizeof *c);

    assert_int_equal(iso_shape_match(few, few, &options, point, c), -EINVAL);
    options.first_pairs = 1;
    assert_int_equal(iso_shape_match(a, b, &options, point, c), -EINVAL);
    options = (struct iso_match_options){.first_pairs = 20, .step = 0, .weight = 0.01};
    assert_int_equal(iso_shape_match(a, b, &options, point, c), -EINVAL);
    options = (struct iso_match_options){.first_pairs = 20, .step = 5, .weight = 0.0};
    assert_int_equal(iso_shape_match(a, b, &options, point, c), -EINVAL);
    iso_shape_free(a);
    iso_shape_free(b);
    iso_shape_free(few);
    iso_mesh_free(mesh);
    iso_mesh_free(other);
    free(old);
    free(point);
    free(c);
    free(again);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_has_great_circles),
        cmocka_unit_test(a_rolled_sheet_keeps_straight_lines),
        cmocka_unit_test(a_shuffled_shape_is_put_in_order),
        cmocka_unit_test(signatures_match_a_shuffled_shape),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
