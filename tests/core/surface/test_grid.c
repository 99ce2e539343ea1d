/* The planes of a grid describe the same surface as the mesh that iso_triangulate makes of the
 * frame. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/core/surfaces/grid_surface.h"

static int set_up(void **state)
{
    struct grid_surface *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *s = grid_surface_hills(2.0, 1.0);
    *state = s;
    return 0;
}

static int tear_down(void **state)
{
    grid_surface_done(*state);
    free(*state);
    return 0;
}

static void triangles_are_those_of_the_mesh_in_the_same_order(void **state)
{
    const struct grid_surface *s = *state;
    int32_t t = 0;
    int single = 0;
    for (int row = 0; row < s->grid->height; row++) {
        for (int column = 0; column < s->grid->width; column++) {
            int32_t at = row * s->grid->stride + column;
            struct iso_cell_list list = iso_cell_list(s->grid->cell[at]);
            single += list.count == 1;
            for (int h = 0; h < list.count; h++, t++) {
                assert_true(t < s->mesh->n_triangles);
                for (int k = 0; k < 3; k++) {
                    int32_t vertex = s->mesh->triangles[t][k];
                    assert_int_equal(
                        iso_grid_corner(s->grid, at, iso_cell_corners[list.left_out[h]][k]),
                        s->plane_index[vertex]);
                }
                double area = iso_mesh_triangle_area(s->mesh, t);
                assert_true(fabs((double)s->grid->cell_mm2[list.left_out[h]][at] - area) <
                            1e-5 * area);
            }
            for (int k = 0; k < 4; k++) {
                bool there = s->grid->cell[at] >> k & 1;
                assert_true(there == (s->grid->cell_mm2[k][at] > 0.0f));
            }
        }
    }
    assert_int_equal(t, s->mesh->n_triangles);
    assert_true(single > 10);
}

static void vertices_and_their_shares_are_those_of_the_mesh(void **state)
{
    const struct grid_surface *s = *state;
    int32_t next = 0;
    double shares = 0.0;
    for (int row = -1; row <= s->grid->height; row++) {
        for (int column = -1; column <= s->grid->width; column++) {
            int32_t at = row * s->grid->stride + column;
            if (s->grid->share_mm2[at] > 0.0f) {
                assert_int_equal(s->plane_index[next], at);
                struct iso_vec3 off = iso_sub(iso_grid_vertex(s->grid, at),
                                              s->mesh->vertices_mm[next]);
                assert_true(iso_norm(off) < 1e-12);
                next++;
            }
            shares += (double)s->grid->share_mm2[at];
        }
    }
    assert_int_equal(next, s->mesh->n_vertices);
    assert_true(fabs(shares / iso_mesh_area(s->mesh) - 1.0) < 1e-6);
}

static void places_are_those_of_the_mesh(void **state)
{
    const struct grid_surface *s = *state;
    int found = 0, missed = 0;
    for (int i = 0; i < 4000; i++) {
        double column = fmod(0.7548776662 * i, 1.0) * 78.0 - 2.0;
        double row = fmod(0.5698402910 * i, 1.0) * 61.0 - 2.0;
        struct iso_grid_point on_grid;
        struct iso_surface_point on_mesh;
        int error = iso_grid_locate(s->grid, column, row, &on_grid);
        assert_int_equal(error, iso_triangulate_locate(s->triangulator, column, row, &on_mesh));
        found += error == 0;
        missed += error == -ENOENT;
        if (!error) {
            struct iso_vec3 off = iso_sub(iso_grid_point_at(s->grid, &on_grid),
                                          iso_mesh_point_at(s->mesh, on_mesh));
            assert_true(iso_norm(off) < 1e-9);
            assert_true(fabs(on_grid.weight[0] + on_grid.weight[1] + on_grid.weight[2] - 1.0) <
                        1e-12);
        }
    }
    assert_true(found > 2000 && missed > 100);
    assert_int_equal(found + missed, 4000);
    struct iso_grid_point none = {{7, 8, 9}, {0}};
    assert_int_equal(iso_grid_locate(s->grid, NAN, 3.0, &none), -ENOENT);
    assert_int_equal(none.corner[2], 9);
}

static void a_grid_can_be_built_again(void **state)
{
    struct grid_surface *s = *state;
    struct grid_surface flat = grid_surface_hills(2.0, 0.0);
    assert_int_equal(iso_grid_build(s->grid, flat.frame, 10.0), 0);
    for (int row = 0; row < s->grid->height; row++) {
        for (int column = 0; column < s->grid->width; column++) {
            int32_t at = row * s->grid->stride + column;
            assert_int_equal(s->grid->cell[at], flat.grid->cell[at]);
            assert_true(s->grid->share_mm2[at] == flat.grid->share_mm2[at]);
            assert_true(s->grid->cell_mm2[1][at] == flat.grid->cell_mm2[1][at]);
        }
    }
    grid_surface_done(&flat);
}

static void impossible_grids_are_refused(void **state)
{
    struct grid_surface *s = *state;
    struct iso_grid *none = NULL;
    const int sizes[][2] = {{1, 9}, {9, 1}, {2049, 9}, {9, 2049}, {-3, 4}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        assert_int_equal(iso_grid_new(sizes[i][0], sizes[i][1], &none), -EINVAL);
    }
    assert_null(none);
    iso_grid_free(NULL);
    s->frame->camera.projection = ISO_PINHOLE;
    assert_int_equal(iso_grid_build(s->grid, s->frame, 40.0), -EINVAL);
    s->frame->camera.projection = ISO_ORTHOGRAPHIC;
    s->frame->height_px--;
    assert_int_equal(iso_grid_build(s->grid, s->frame, 40.0), -EINVAL);
    s->frame->height_px++;
    for (int i = 0; i < s->frame->width_px * s->frame->height_px; i++) {
        s->frame->depth_mm[i] = i % 2 ? 0.0f : 100.0f;
    }
    assert_int_equal(iso_grid_build(s->grid, s->frame, 40.0), -ENODATA);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(triangles_are_those_of_the_mesh_in_the_same_order, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(vertices_and_their_shares_are_those_of_the_mesh, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(places_are_those_of_the_mesh, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_grid_can_be_built_again, set_up, tear_down),
        cmocka_unit_test_setup_teardown(impossible_grids_are_refused, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
