/* Local heat and the distance of a part from a whole: the closed form of a sphere, what a cut
 * leaves as it was, and that a part is found again. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/shape/classify/feature_distance.h"
#include "core/shape/partial/local_heat.h"
#include "core/shape/partial/partial_distance.h"
#include "core/shape/partial/surface_points.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

enum { COARSE = ISO_LOCAL_COARSE, POINTS = ISO_LOCAL_POINTS, TIMES = ISO_LOCAL_TIMES };

static struct iso_shape *shape_of(struct iso_mesh *mesh)
{
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_shape_new(mesh, NULL, 0, &shape), 0);
    iso_mesh_free(mesh);
    return shape;
}

static struct iso_shape_description *described(const struct iso_shape *shape)
{
    struct iso_shape_description *d = NULL;
    assert_int_equal(iso_shape_describe(iso_shape_method_find("local-heat"), shape, &d), 0);
    assert_int_equal(d->n_parts, ISO_LOCAL_PARTS);
    return d;
}

/* Removes the triangles whose three corners are above z. */
static struct iso_mesh *cut_above(struct iso_mesh *mesh, double z)
{
    int32_t kept = 0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *c = mesh->triangles[t];
        if (mesh->vertices_mm[c[0]].z < z || mesh->vertices_mm[c[1]].z < z ||
            mesh->vertices_mm[c[2]].z < z) {
            memmove(mesh->triangles[kept++], c, sizeof *mesh->triangles);
        }
    }
    mesh->n_triangles = kept;
    return mesh;
}

/* A bent club with one thick end, so that it has no symmetry; `thick` sets the other end. */
static struct iso_mesh *club(double scale, double thick)
{
    struct iso_mesh *mesh = shape_sphere(4, 10.0);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 *p = &mesh->vertices_mm[v];
        const double wide = p->z > 0.0 ? 1.0 + 0.04 * p->z : 1.0 + thick * p->z;
        *p = iso_vec3(scale * wide * p->x + scale * 0.02 * p->z * p->z, scale * 0.8 * wide * p->y,
                      scale * 3.0 * p->z);
    }
    return mesh;
}

/* log(A K) on a sphere of radius 1 after so long, by the pairs that a shape has: 100, l up to 9. */
static double sphere_log_heat(double t)
{
    double sum = 0.0;
    for (int l = 0; l < 10; l++) {
        sum += (2 * l + 1) * exp(-l * (l + 1) * t);
    }
    return log(sum);
}

/* How far the heat at all points of a sphere is from the closed form. */
static double worst_on_sphere(const struct iso_shape_description *d)
{
    double worst = 0.0;
    for (int i = 0; i < POINTS * TIMES; i++) {
        const double t = 4.0 * M_PI * exp2(ISO_LOCAL_FIRST + i % TIMES * ISO_LOCAL_STEP);
        worst = fmax(worst, fabs((double)d->whole[2 * COARSE + i] - sphere_log_heat(t)));
    }
    return worst;
}

static void heat_on_a_sphere_is_the_closed_form(void **state)
{
    (void)state;
    struct iso_shape *shape = shape_of(shape_sphere(4, 3.0));
    struct iso_shape_description *d = described(shape);
    double share = 0.0;
    for (int p = 0; p < COARSE; p++) {
        share += (double)d->whole[p];
        assert_true(d->whole[p] > 0.0f);
        assert_near(d->whole[COARSE + p], ISO_LOCAL_FAR, 1e-3);
    }
    print_message("off by %.4f\n", worst_on_sphere(d));
    assert_true(worst_on_sphere(d) < 0.01);
    assert_near(share, 1.0, 1e-5);
    iso_shape_description_free(d);
    iso_shape_free(shape);
}

/* Farthest points first: none of them is nearer to another one than any vertex may be to its
 * nearest point. On a flat sheet a way along the edges is not shorter than the straight line. */
static void points_are_spread_evenly(void **state)
{
    (void)state;
    enum { N = 40 };
    struct iso_shape *shape = shape_of(shape_sheet(31, 21, 1.0));
    int32_t vertex[N], few[800];
    double weight[N], shares[800], sum = 0.0, apart = INFINITY, cover = 0.0;
    assert_int_equal(iso_surface_points(shape, 5, N, vertex, weight), 0);
    assert_int_equal(vertex[0], 5);
    for (int32_t v = 0; v < shape->mesh->n_vertices; v++) {
        double nearest = INFINITY;
        for (int p = 0; p < N; p++) {
            const double d = iso_norm(
                iso_sub(shape->mesh->vertices_mm[v], shape->mesh->vertices_mm[vertex[p]]));
            nearest = fmin(nearest, d);
        }
        cover = fmax(cover, nearest);
    }
    for (int p = 0; p < N; p++) {
        sum += weight[p];
        for (int q = 0; q < p; q++) {
            apart = fmin(apart, iso_norm(iso_sub(shape->mesh->vertices_mm[vertex[p]],
                                                 shape->mesh->vertices_mm[vertex[q]])));
        }
    }
    assert_near(sum, 1.0, 1e-12);
    assert_true(cover > 1.0 && cover < 4.5); /* a grid of 40 points would cover by 2.7 */
    assert_true(apart > 0.7 * cover);        /* ways along edges are up to sqrt(2) longer */
    /* A shape of fewer vertices has each of them once. */
    assert_int_equal(iso_surface_points(shape, 9, 800, few, shares), 0);
    for (int p = 0; p < 800; p++) {
        assert_true(p < 31 * 21 ? shares[p] > 0.0 : shares[p] == 0.0 && few[p] == 9);
    }
    iso_shape_free(shape);
}

static void distance_from_the_boundary_is_measured(void **state)
{
    (void)state;
    struct iso_shape *disc = shape_of(shape_disc(20, 10.0)), *ball = shape_of(shape_sphere(2, 1.0));
    double *distance = calloc((size_t)disc->mesh->n_vertices, sizeof *distance);
    assert_non_null(distance);
    assert_int_equal(iso_boundary_distance(disc, distance), 0);
    for (int32_t v = 0; v < disc->mesh->n_vertices; v++) {
        const double inside = fmax(9.0 - iso_norm(disc->mesh->vertices_mm[v]), 0.0);
        assert_true(distance[v] > inside - 1e-9 && distance[v] < 1.16 * inside + 1e-9);
    }
    assert_int_equal(iso_boundary_distance(ball, distance), 0);
    assert_true(isinf(distance[0]) && isinf(distance[ball->mesh->n_vertices - 1]));
    free(distance);
    iso_shape_free(disc);
    iso_shape_free(ball);
}

/* A tenth of a sphere is cut away. Heat at a point is that of the whole sphere, up to the share
 * that the distance gives to the time as being reached by the boundary, exp(-d^2 / 4t). */
static void a_cut_reaches_only_what_is_near(void **state)
{
    (void)state;
    struct iso_shape *shape = shape_of(cut_above(shape_sphere(4, 1.0), 0.8));
    struct iso_shape_description *d = described(shape);
    int certain = 0, changed = 0;
    assert_near(shape->total_area, 4.0 * M_PI * 0.9, 0.15);
    for (int p = 0; p < COARSE; p++) {
        for (int j = 0; j < TIMES; j++) {
            const double t = exp2(ISO_LOCAL_FIRST + j * ISO_LOCAL_STEP); /* in areas */
            const double bound = exp(-(double)d->whole[COARSE + p] / (4.0 * t));
            const double whole = sphere_log_heat(t * shape->total_area) -
                                 log(4.0 * M_PI / shape->total_area);
            const double off = fabs((double)d->whole[2 * COARSE + TIMES * p + j] - whole);
            assert_true(off < bound + 0.02);
            certain += bound < 0.05;
            changed += off > 0.2;
        }
    }
    print_message("%d of %d are certain, %d changed by more than 0.2\n", certain, COARSE * TIMES,
                  changed);
    assert_true(certain > 1000);
    assert_true(changed > 100); /* of all that is near, so the bound is no idle one */
    iso_shape_description_free(d);
    iso_shape_free(shape);
}

/* Distances of the query from three shapes, and the area of the whole in areas of the query. */
static void compare(const struct iso_shape_description *query,
                    struct iso_shape_description *const item[3], double distance[3], double *ratio)
{
    struct iso_partial_query *q = NULL;
    assert_int_equal(iso_partial_query_new(query->whole, &q), 0);
    for (int i = 2; i >= 0; i--) {
        distance[i] = iso_partial_distance(q, item[i]->whole, ratio);
    }
    iso_partial_query_free(q);
}

/* The first of three shapes is the whole. */
static void a_part_is_found_again(void **state)
{
    (void)state;
    struct iso_shape *whole = shape_of(club(1.0, 0.0)), *large = shape_of(club(4.7, 0.0)),
                     *other = shape_of(club(1.0, 0.06)),
                     *part = shape_of(cut_above(club(1.0, 0.0), 20.0));
    struct iso_shape_description *const item[3] = {described(whole), described(large),
                                                   described(other)};
    struct iso_shape_description *cut = described(part);
    double distance[3], back[3], ratio;
    compare(item[0], item, distance, &ratio);
    print_message("whole: %.4f %.4f %.4f\n", distance[0], distance[1], distance[2]);
    assert_near(distance[0], 0.0, 2e-3);
    assert_near(distance[1], 0.0, 2e-3); /* the size does not matter */
    assert_near(ratio, 1.0, 1e-9);
    assert_true(distance[2] > 0.01);
    compare(cut, item, distance, &ratio);
    print_message("%.2f of it: %.4f %.4f %.4f, ratio %.2f\n", part->total_area / whole->total_area,
                  distance[0], distance[1], distance[2], ratio);
    assert_true(distance[0] < 0.5 * distance[2]);
    assert_true(fabs(log2(ratio) - log2(whole->total_area / part->total_area)) < 0.2);
    /* The whole is not found in the part. */
    struct iso_shape_description *const parts[3] = {cut, cut, cut};
    compare(item[0], parts, back, &ratio);
    print_message("the whole from the part: %.4f\n", back[0]);
    assert_true(back[0] > distance[0]);
    for (int i = 0; i < 3; i++) {
        iso_shape_description_free(item[i]);
    }
    iso_shape_description_free(cut);
    iso_shape_free(whole);
    iso_shape_free(large);
    iso_shape_free(other);
    iso_shape_free(part);
}

/* Ten of the query's points are like nothing: each adds the largest difference, and the others are
 * found as before. Without a bound the distance would be a hundred times as large. */
static void a_wrong_point_adds_a_bounded_difference(void **state)
{
    (void)state;
    enum { WRONG = 10 };
    struct iso_shape *whole = shape_of(club(1.0, 0.0));
    struct iso_shape_description *right = described(whole), *wrong = described(whole);
    struct iso_shape_description *const item[3] = {right, right, right};
    double share = 0.0, clean[3], distance[3], ratio;
    for (int p = 0; p < WRONG; p++) {
        share += (double)wrong->whole[p];
        for (int j = 0; j < TIMES; j++) {
            wrong->whole[2 * COARSE + TIMES * p + j] += 20.0f;
        }
    }
    compare(right, item, clean, &ratio);
    compare(wrong, item, distance, &ratio);
    print_message("%.4f, with %.3f of it wrong %.4f\n", clean[0], share, distance[0]);
    assert_true(share > 0.01);
    assert_near(distance[0], 0.2 * share + (1.0 - share) * clean[0], 0.02 * share);
    assert_near(ratio, 1.0, 1e-9);
    iso_shape_description_free(right);
    iso_shape_description_free(wrong);
    iso_shape_free(whole);
}

/* A difference d counts as d / (1 + d / 0.2). Here all points of the query differ from all others
 * by the same, and least, by 0.2, for the smallest area that is tried, 2^-0.2 of the query's. */
static void a_difference_counts_by_its_formula(void **state)
{
    (void)state;
    struct iso_shape *whole = shape_of(club(1.0, 0.0));
    struct iso_shape_description *query = described(whole), *other = described(whole);
    struct iso_shape_description *const item[3] = {other, other, other};
    double distance[3], ratio;
    for (int i = 0; i < TIMES * POINTS; i++) {
        query->whole[2 * COARSE + i] = 0.0f;
        other->whole[2 * COARSE + i] = (float)(-0.2 - 0.2 * log(2.0));
    }
    compare(query, item, distance, &ratio);
    assert_near(distance[0], 0.1, 1e-3);
    assert_near(ratio, exp2(-0.2), 1e-9);
    iso_shape_description_free(query);
    iso_shape_description_free(other);
    iso_shape_free(whole);
}

/* A shape of 42 vertices has as many points; all are near the boundary of a small sheet. */
static void small_shapes_have_a_distance(void **state)
{
    (void)state;
    struct iso_shape *ball = shape_of(shape_sphere(1, 1.0)),
                     *sheet = shape_of(shape_sheet(6, 6, 1));
    struct iso_shape_description *const item[3] = {described(ball), described(sheet),
                                                   described(ball)};
    double distance[3], ratio;
    compare(item[1], item, distance, &ratio);
    assert_near(distance[1], 0.0, 2e-3);
    assert_true(isfinite(distance[0]) && distance[0] > 0.1);
    for (int i = 0; i < 3; i++) {
        iso_shape_description_free(item[i]);
    }
    iso_shape_free(ball);
    iso_shape_free(sheet);
}

static void other_features_are_refused(void **state)
{
    (void)state;
    const struct iso_feature_layout layout = {4, 3, {1, 1, 2}, ISO_NORM_PARTIAL};
    const float a[4] = {1, 2, 3, 4}, b[4] = {1, 0, 3, 7};
    double distance[1] = {-1.0};
    assert_false(iso_is_local_heat(&layout));
    assert_int_equal(iso_feature_distances(&layout, ISO_NORM_PARTIAL, a, b, 1, -1, distance),
                     -EINVAL);
    assert_near(distance[0], -1.0, 0.0);
    assert_int_equal(iso_feature_distances(&layout, ISO_NORM_L1, a, b, 1, -1, distance), 0);
    assert_near(distance[0], 5.0, 1e-12);
    assert_int_equal(iso_feature_distances(&layout, ISO_NORM_L2, a, b, 1, -1, distance), 0);
    assert_near(distance[0], sqrt(13.0), 1e-12);
    iso_partial_query_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heat_on_a_sphere_is_the_closed_form),
        cmocka_unit_test(points_are_spread_evenly),
        cmocka_unit_test(distance_from_the_boundary_is_measured),
        cmocka_unit_test(a_cut_reaches_only_what_is_near),
        cmocka_unit_test(a_part_is_found_again),
        cmocka_unit_test(a_wrong_point_adds_a_bounded_difference),
        cmocka_unit_test(a_difference_counts_by_its_formula),
        cmocka_unit_test(small_shapes_have_a_distance),
        cmocka_unit_test(other_features_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
