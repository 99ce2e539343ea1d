/* Meshes: areas, neighbours, pieces and borders of shapes that are simple enough to count by hand.
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

#include "tests/core/surfaces/shapes.h"

enum { TRIANGLES_MAX = 2000 };

static int32_t adjacent[TRIANGLES_MAX][3];

static const int32_t (*neighbours(const struct iso_mesh *mesh))[3]
{
    assert_true(mesh->n_triangles <= TRIANGLES_MAX);
    assert_int_equal(iso_mesh_adjacency(mesh, adjacent), 0);
    return (const int32_t(*)[3])adjacent;
}

static void set_triangle(struct iso_mesh *mesh, int32_t a, int32_t b, int32_t c)
{
    int32_t *v = mesh->triangles[mesh->n_triangles++];
    v[0] = a;
    v[1] = b;
    v[2] = c;
}

static void areas_add_up(void **state)
{
    (void)state;
    struct iso_mesh *sheet = shape_sheet(7, 4, 1.5);
    assert_true(fabs(iso_mesh_area(sheet) - 6 * 1.5 * 3 * 1.5) < 1e-12);
    assert_true(fabs(iso_mesh_triangle_area(sheet, 5) - 0.5 * 1.5 * 1.5) < 1e-12);
    struct iso_surface_point p = shape_locate(sheet, 2.1, -0.4);
    struct iso_vec3 at = iso_mesh_point_at(sheet, p);
    assert_true(fabs(at.x - 2.1) < 1e-12 && fabs(at.y + 0.4) < 1e-12 && at.z == 0.0);
    iso_mesh_free(sheet);

    struct iso_mesh *sphere = shape_sphere(3, 10.0);
    assert_int_equal(sphere->n_vertices, 642);
    assert_int_equal(iso_mesh_check(sphere, NULL), 0);
    assert_true(fabs(iso_mesh_area(sphere) / (400.0 * M_PI) - 1.0) < 0.01);
    iso_mesh_free(sphere);
    iso_mesh_free(NULL);
}

static void a_closed_surface_has_a_neighbour_everywhere(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sphere(2, 1.0);
    const int32_t(*next)[3] = neighbours(mesh);
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            int32_t other = next[t][k];
            assert_in_range(other, 0, mesh->n_triangles - 1);
            assert_true(next[other][0] == t || next[other][1] == t || next[other][2] == t);
            /* They share the two corners of the edge, and not the one opposite to it. */
            int shared = 0;
            for (int i = 0; i < 3; i++) {
                int32_t v = mesh->triangles[other][i];
                assert_int_not_equal(v, mesh->triangles[t][k]);
                shared += v == mesh->triangles[t][(k + 1) % 3];
                shared += v == mesh->triangles[t][(k + 2) % 3];
            }
            assert_int_equal(shared, 2);
        }
    }
    uint8_t border[200];
    iso_mesh_boundary(mesh, next, border);
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        assert_int_equal(border[i], 0);
    }
    iso_mesh_free(mesh);
}

static void the_border_of_a_sheet_is_its_rim(void **state)
{
    (void)state;
    enum { COLUMNS = 9, ROWS = 5 };
    struct iso_mesh *mesh = shape_sheet(COLUMNS, ROWS, 2.0);
    uint8_t border[COLUMNS * ROWS];
    iso_mesh_boundary(mesh, neighbours(mesh), border);
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        int column = i % COLUMNS, row = i / COLUMNS;
        bool rim = column == 0 || column == COLUMNS - 1 || row == 0 || row == ROWS - 1;
        assert_int_equal(border[i], rim);
    }
    iso_mesh_free(mesh);
}

static void an_edge_joins_its_first_two_triangles(void **state)
{
    (void)state;
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(5, 3, &mesh), 0);
    mesh->n_vertices = 5;
    set_triangle(mesh, 0, 1, 2); /* a book of three pages */
    set_triangle(mesh, 1, 0, 3);
    set_triangle(mesh, 0, 1, 4);
    const int32_t(*next)[3] = neighbours(mesh);
    assert_int_equal(next[0][2], 1);
    assert_int_equal(next[1][2], 0);
    assert_int_equal(next[2][2], -1);
    uint8_t border[5];
    iso_mesh_boundary(mesh, next, border);
    assert_true(border[0] && border[4]);
    iso_mesh_free(mesh);
}

static void pieces_are_numbered_by_falling_area(void **state)
{
    (void)state;
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(11, 4, &mesh), 0);
    mesh->n_vertices = 11;
    memset(mesh->vertices_mm, 0, 11 * sizeof *mesh->vertices_mm);
    const double x[11] = {0, 1, 0, 10, 15, 10, 20, 22, 20, 22, 21};
    const double y[11] = {0, 0, 1, 0, 0, 5, 0, 0, 3, 3, 9};
    for (int i = 0; i < 11; i++) {
        mesh->vertices_mm[i] = iso_vec3(x[i], y[i], 0.0);
    }
    set_triangle(mesh, 0, 1, 2); /* 0.5 mm^2 */
    set_triangle(mesh, 3, 4, 5); /* 12.5 */
    set_triangle(mesh, 6, 7, 8); /* 3 + 3, joined */
    set_triangle(mesh, 7, 9, 8);
    int32_t piece[4] = {-7, -7, -7, -7};
    assert_int_equal(iso_mesh_components(mesh, neighbours(mesh), piece), 3);
    const int32_t expected[4] = {2, 0, 1, 1};
    assert_memory_equal(piece, expected, sizeof expected);
    iso_mesh_free(mesh);
}

static void impossible_meshes_are_refused(void **state)
{
    (void)state;
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(0, 1, &mesh), -EINVAL);
    assert_int_equal(iso_mesh_new(1, 0, &mesh), -EINVAL);
    assert_null(mesh);
    mesh = shape_sheet(3, 4, 1.0);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_mesh_check(mesh, &fault), 0);
    assert_string_equal(fault.text, "");
    const int32_t wrong[] = {-1, 12, INT32_MAX};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        int32_t kept = mesh->triangles[4][1];
        mesh->triangles[4][1] = wrong[i];
        fault.text[0] = '\0';
        assert_int_equal(iso_mesh_check(mesh, &fault), -EINVAL);
        assert_true(fault.text[0] != '\0');
        mesh->triangles[4][1] = kept;
    }
    int32_t kept = mesh->triangles[2][0];
    mesh->triangles[2][0] = mesh->triangles[2][2];
    assert_int_equal(iso_mesh_check(mesh, NULL), -EINVAL);
    mesh->triangles[2][0] = kept;
    mesh->vertices_mm[11].z = NAN;
    assert_int_equal(iso_mesh_check(mesh, &fault), -EINVAL);
    mesh->vertices_mm[11].z = INFINITY;
    assert_int_equal(iso_mesh_check(mesh, &fault), -EINVAL);
    iso_mesh_free(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_add_up),
        cmocka_unit_test(a_closed_surface_has_a_neighbour_everywhere),
        cmocka_unit_test(the_border_of_a_sheet_is_its_rim),
        cmocka_unit_test(an_edge_joins_its_first_two_triangles),
        cmocka_unit_test(pieces_are_numbered_by_falling_area),
        cmocka_unit_test(impossible_meshes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
