/* The best views of a box, which are known, and of a mesh that was turned. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isotherm/signature.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

enum { GRID = 6, FACE = (GRID + 1) * (GRID + 1), VIEWS = 8 };

/* A box about the origin. Each of its faces has GRID x GRID rectangles of two triangles. */
static struct iso_mesh *make_box(struct iso_vec3 half)
{
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(6 * FACE, 12 * GRID * GRID, &mesh), 0);
    for (int face = 0; face < 6; face++) {
        const double side = face % 2 ? 1.0 : -1.0;
        for (int i = 0; i < FACE; i++) {
            const double u = 2.0 * (i % (GRID + 1)) / GRID - 1.0;
            const double v = 2.0 * (i / (GRID + 1)) / GRID - 1.0;
            const struct iso_vec3 at = face < 2   ? iso_vec3(side, u, v)
                                       : face < 4 ? iso_vec3(u, side, v)
                                                  : iso_vec3(u, v, side);
            mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(half.x * at.x, half.y * at.y,
                                                             half.z * at.z);
        }
        for (int q = 0; q < GRID * GRID; q++) {
            const int32_t a = face * FACE + q / GRID * (GRID + 1) + q % GRID;
            const int32_t two[2][3] = {{a, a + 1, a + GRID + 2}, {a, a + GRID + 2, a + GRID + 1}};
            memcpy(mesh->triangles[mesh->n_triangles], two, sizeof two);
            mesh->n_triangles += 2;
        }
    }
    return mesh;
}

/* The angle between a direction and the nearest of the eight (+-x, +-y, +-z), in degrees. */
static double degrees_off(struct iso_vec3 d, struct iso_vec3 diagonal)
{
    const struct iso_vec3 one = iso_unit(d), other = iso_unit(diagonal);
    const double cosine = fabs(one.x) * other.x + fabs(one.y) * other.y + fabs(one.z) * other.z;
    return acos(fmin(1.0, cosine)) * 180.0 / M_PI;
}

/* Of a box of half sides a, b, c a viewer in direction (x, y, z) sees three faces, in the ratio
 * x b c : y a c : z a b. If all faces have the same number N of equal triangles, the entropy is
 * that of three faces plus log2 N: the best view shows the three faces at equal size, and is the
 * diagonal (a, b, c) of the box. The divergence is least where the ratio is that of the areas: from
 * (1, 1, 1), whatever the box is. Half of the surface is seen then, which is 1 bit. */
static void a_box_is_best_seen_along_its_diagonals(void **state)
{
    (void)state;
    const struct iso_vec3 half = {3.0, 2.0, 1.2}, equal = {1.0, 1.0, 1.0};
    struct iso_mesh *box = make_box(half);
    struct iso_shape_view view[VIEWS];
    int n = 0;
    assert_int_equal(iso_shape_views(box, ISO_VIEW_ENTROPY, 0.6, VIEWS, view, &n), 0);
    assert_int_equal(n, VIEWS);
    for (int i = 0; i < n; i++) {
        print_message("entropy %.4f, %.2f degrees off\n", view[i].entropy,
                      degrees_off(view[i].direction, half));
        assert_true(degrees_off(view[i].direction, half) < 3.0);
    }
    assert_near(view[0].entropy, log2(3.0) + log2(2.0 * GRID * GRID), 0.003);
    assert_int_equal(iso_shape_views(box, ISO_VIEW_DIVERGENCE, 0.6, VIEWS, view, &n), 0);
    assert_int_equal(n, VIEWS);
    for (int i = 0; i < n; i++) {
        print_message("divergence %.4f, %.2f degrees off\n", view[i].divergence,
                      degrees_off(view[i].direction, equal));
        assert_true(degrees_off(view[i].direction, equal) < 3.0);
        assert_near(view[i].divergence, 1.0, 0.002);
        for (int j = 0; j < i; j++) {
            assert_true(iso_dot(view[i].direction, view[j].direction) <= cos(0.6) + 1e-12);
        }
    }
    iso_mesh_free(box);
}

/* Along an axis of the box one face is seen: N equal triangles, and one of areas 2 (ab + bc + ca)
 * over that of the face. */
static void a_view_of_one_face_has_its_scores(void **state)
{
    (void)state;
    const struct iso_vec3 half = {3.0, 2.0, 1.2};
    struct iso_mesh *box = make_box(half);
    const double all = 2.0 * (3.0 * 2.0 + 2.0 * 1.2 + 1.2 * 3.0);
    const double face[3] = {2.0 * 1.2, 3.0 * 1.2, 3.0 * 2.0};
    for (int k = 0; k < 3; k++) {
        const struct iso_vec3 along = {k == 0 ? -2.0 : 0.0, k == 1 ? 0.5 : 0.0, k == 2 ? 9.0 : 0.0};
        struct iso_shape_view view;
        assert_int_equal(iso_shape_view_of(box, along, &view), 0);
        assert_near(view.entropy, log2(2.0 * GRID * GRID), 0.01);
        assert_near(view.divergence, log2(all / face[k]), 0.01);
        assert_near(iso_norm(view.direction), 1.0, 1e-12);
    }
    iso_mesh_free(box);
}

/* From its edge a flat sheet covers no pixel. From its front all of it is seen: no divergence. */
static void a_flat_sheet_is_best_seen_from_its_front(void **state)
{
    (void)state;
    struct iso_mesh *sheet = make_box(iso_vec3(3.0, 2.0, 1.2));
    struct iso_shape_view view;
    int n = 0;
    memmove(sheet->triangles, sheet->triangles + 8 * GRID * GRID,
            2 * GRID * GRID * sizeof *sheet->triangles); /* the face z = -1.2 */
    sheet->n_triangles = 2 * GRID * GRID;
    assert_int_equal(iso_shape_view_of(sheet, iso_vec3(1.0, 0.0, 0.0), &view), 0);
    assert_true(isinf(view.divergence) && view.divergence > 0.0);
    assert_near(view.entropy, 0.0, 1e-12);
    assert_int_equal(iso_shape_views(sheet, ISO_VIEW_DIVERGENCE, 0.5, 1, &view, &n), 0);
    assert_int_equal(n, 1);
    assert_near(view.divergence, 0.0, 0.01);
    assert_true(fabs(view.direction.z) > 0.2);
    iso_mesh_free(sheet);
}

/* A closed body without any symmetry. */
static struct iso_mesh *make_body(void)
{
    struct iso_mesh *mesh = shape_sphere(4, 1.0);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const struct iso_vec3 p = mesh->vertices_mm[v];
        const double limb = exp(4.0 * (p.x - 1.0)) + 0.6 * exp(6.0 * (0.6 * p.y + 0.8 * p.z - 1.0));
        const double size = 1.0 + 1.3 * limb + 0.2 * p.z * p.x + 0.1 * p.y;
        mesh->vertices_mm[v] = iso_vec3(size * p.x, 0.8 * size * p.y, 0.6 * size * p.z);
    }
    return mesh;
}

static void turn_mesh(struct iso_mesh *mesh, const struct iso_mat3 *rotation, double size)
{
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const struct iso_vec3 at = iso_mat3_apply(rotation, iso_scale(size, mesh->vertices_mm[v]));
        mesh->vertices_mm[v] = iso_add(at, iso_vec3(5.0, -3.0, 40.0));
    }
}

static void views_turn_with_the_mesh(void **state)
{
    (void)state;
    enum { N = 4 };
    const struct iso_mat3 rotation = iso_mat3_rotation(iso_vec3(1.1, -0.7, 0.4));
    for (int score = ISO_VIEW_ENTROPY; score <= ISO_VIEW_DIVERGENCE; score++) {
        struct iso_mesh *mesh = make_body();
        struct iso_shape_view before[N], after[N];
        int n = 0, m = 0;
        assert_int_equal(iso_shape_views(mesh, (enum iso_view_score)score, 0.7, N, before, &n), 0);
        turn_mesh(mesh, &rotation, 0.01);
        assert_int_equal(iso_shape_views(mesh, (enum iso_view_score)score, 0.7, N, after, &m), 0);
        assert_int_equal(n, m);
        for (int i = 0; i < n; i++) {
            const struct iso_vec3 turned = iso_mat3_apply(&rotation, before[i].direction);
            print_message("turned: %.4f of %.4f, %.2g apart\n", after[i].entropy, before[i].entropy,
                          iso_norm(iso_sub(turned, after[i].direction)));
            assert_near(after[i].entropy, before[i].entropy, 0.005);
            assert_near(after[i].divergence, before[i].divergence, 0.005);
            assert_near(iso_norm(iso_sub(turned, after[i].direction)), 0.0, 0.02);
        }
        iso_mesh_free(mesh);
    }
}

static void refuses_what_cannot_be_seen(void **state)
{
    (void)state;
    struct iso_mesh *box = make_box(iso_vec3(1.0, 1.0, 1.0));
    struct iso_shape_view view = {.entropy = 7.0};
    int n = 5;
    assert_int_equal(iso_shape_views(box, ISO_VIEW_ENTROPY, 0.5, 0, &view, &n), -EINVAL);
    assert_int_equal(iso_shape_views(box, ISO_VIEW_ENTROPY, 0.0, 1, &view, &n), -EINVAL);
    assert_int_equal(iso_shape_views(box, ISO_VIEW_ENTROPY, 3.2, 1, &view, &n), -EINVAL);
    assert_int_equal(iso_shape_view_of(box, iso_vec3(0.0, 0.0, 0.0), &view), -EINVAL);
    assert_int_equal(iso_shape_view_of(box, iso_vec3(NAN, 0.0, 0.0), &view), -EINVAL);
    for (int32_t v = 0; v < box->n_vertices; v++) {
        box->vertices_mm[v].x = box->vertices_mm[v].y = 0.0;
    }
    assert_int_equal(iso_shape_views(box, ISO_VIEW_ENTROPY, 0.5, 1, &view, &n), -EINVAL);
    box->n_triangles = 0;
    assert_int_equal(iso_shape_view_of(box, iso_vec3(0.0, 0.0, 1.0), &view), -EINVAL);
    assert_near(view.entropy, 7.0, 0.0);
    assert_int_equal(n, 5);
    iso_mesh_free(box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_best_seen_along_its_diagonals),
        cmocka_unit_test(a_view_of_one_face_has_its_scores),
        cmocka_unit_test(a_flat_sheet_is_best_seen_from_its_front),
        cmocka_unit_test(views_turn_with_the_mesh),
        cmocka_unit_test(refuses_what_cannot_be_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
