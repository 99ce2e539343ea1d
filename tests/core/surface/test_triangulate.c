/* The mesh of a frame with missing pixels keeps all promises of the header. (Regular frames and
 * errors are in test_surface.c.) */
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

#include "isotherm/triangulate.h"

enum { WIDE = 37, HIGH = 23, PIXELS = WIDE * HIGH };

static const double jump_mm = 12.0;

struct fixture {
    float depth_mm[PIXELS];
    struct iso_frame frame;
    struct iso_triangulator *triangulator;
    struct iso_mesh *mesh;
};

/* A cropped pinhole view of two surfaces, one 80 mm behind the other, with a tenth of the pixels
 * missing at random. */
static void set_up(struct fixture *f, bool largest_only)
{
    srand48(6021023);
    for (int i = 0; i < PIXELS; i++) {
        int column = i % WIDE, row = i / WIDE;
        bool behind = column > 25 + row % 3;
        double z = 600.0 + 0.9 * column - 0.4 * row + (behind ? 80.0 : 0.0) + 3.0 * drand48();
        f->depth_mm[i] = drand48() < 0.1 ? 0.0f : (float)z;
    }
    f->frame = (struct iso_frame){
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = 320,
                   .height_px = 240,
                   .fx_px = 300.0,
                   .fy_px = 310.0,
                   .cx_px = 155.0,
                   .cy_px = 118.0},
        .width_px = WIDE,
        .height_px = HIGH,
        .crop_x_px = 120,
        .crop_y_px = 90,
        .depth_mm = f->depth_mm,
    };
    const struct iso_triangulate_options options = {jump_mm, largest_only};
    assert_int_equal(iso_triangulator_new(PIXELS, &options, &f->triangulator), 0);
    assert_int_equal(iso_mesh_new(PIXELS, 2 * PIXELS, &f->mesh), 0);
    assert_int_equal(iso_triangulate(f->triangulator, &f->frame, f->mesh), 0);
    assert_int_equal(iso_mesh_check(f->mesh, NULL), 0);
}

static void tear_down(struct fixture *f)
{
    iso_triangulator_free(f->triangulator);
    iso_mesh_free(f->mesh);
}

static void every_triangle_faces_the_camera_and_crosses_no_jump(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f, false);
    uint8_t *used = calloc((size_t)f.mesh->n_vertices, 1);
    assert_non_null(used);
    for (int32_t t = 0; t < f.mesh->n_triangles; t++) {
        const int32_t *v = f.mesh->triangles[t];
        struct iso_vec3 a = f.mesh->vertices_mm[v[0]];
        struct iso_vec3 b = f.mesh->vertices_mm[v[1]], c = f.mesh->vertices_mm[v[2]];
        struct iso_vec3 normal = iso_cross(iso_sub(b, a), iso_sub(c, a));
        assert_true(iso_dot(normal, a) < 0.0); /* against the line of sight */
        double low = fmin(a.z, fmin(b.z, c.z)), high = fmax(a.z, fmax(b.z, c.z));
        assert_true(high - low <= jump_mm);
        used[v[0]] = used[v[1]] = used[v[2]] = 1;
    }
    assert_null(memchr(used, 0, (size_t)f.mesh->n_vertices));
    free(used);
    tear_down(&f);
}

/* The neighbours that the grid gives equal those that the mesh alone gives. */
static void adjacency_is_read_off_the_grid(void **state)
{
    (void)state;
    for (int largest_only = 0; largest_only < 2; largest_only++) {
        struct fixture f;
        set_up(&f, largest_only);
        size_t n = (size_t)f.mesh->n_triangles;
        int32_t(*grid)[3] = calloc(n, sizeof *grid), (*mesh)[3] = calloc(n, sizeof *mesh);
        assert_true(grid && mesh);
        iso_triangulate_adjacency(f.triangulator, grid);
        assert_int_equal(iso_mesh_adjacency(f.mesh, mesh), 0);
        assert_memory_equal(grid, mesh, n * sizeof *grid);
        free(grid);
        free(mesh);
        tear_down(&f);
    }
}

static void the_largest_piece_alone_is_kept(void **state)
{
    (void)state;
    struct fixture all, largest;
    set_up(&all, false);
    set_up(&largest, true);
    size_t n = (size_t)all.mesh->n_triangles;
    int32_t(*adjacent)[3] = calloc(n, sizeof *adjacent), *piece = calloc(n, sizeof *piece);
    assert_true(adjacent && piece);
    assert_int_equal(iso_mesh_adjacency(all.mesh, adjacent), 0);
    int32_t pieces = iso_mesh_components(all.mesh, (const int32_t(*)[3])adjacent, piece);
    assert_true(pieces >= 2);
    double area = 0.0;
    int32_t kept = 0;
    for (size_t t = 0; t < n; t++) {
        area += piece[t] == 0 ? iso_mesh_triangle_area(all.mesh, (int32_t)t) : 0.0;
        kept += piece[t] == 0;
    }
    assert_int_equal(largest.mesh->n_triangles, kept);
    assert_true(fabs(iso_mesh_area(largest.mesh) - area) < 1e-9);
    for (int32_t i = 0; i < largest.mesh->n_vertices; i++) {
        assert_true(largest.mesh->vertices_mm[i].z <
                    650.0); /* the nearer surface, which is wider */
    }
    free(adjacent);
    free(piece);
    tear_down(&all);
    tear_down(&largest);
}

/* A found place is where the frame would see it. Corners are exact, other places are between them.
 */
static void places_are_found_where_they_are_seen(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f, true);
    int found = 0;
    for (int i = 0; i < 2000; i++) {
        double column = (WIDE - 1) * drand48(), row = (HIGH - 1) * drand48();
        if (i % 4 == 0) { /* a pixel */
            column = floor(column);
            row = floor(row);
        }
        struct iso_surface_point p;
        int error = iso_triangulate_locate(f.triangulator, column, row, &p);
        if (error) {
            assert_int_equal(error, -ENOENT);
            continue;
        }
        found++;
        assert_in_range(p.triangle, 0, f.mesh->n_triangles - 1);
        assert_true(fabs(p.weight[0] + p.weight[1] + p.weight[2] - 1.0) < 1e-12);
        double u, v;
        assert_true(iso_camera_project(&f.frame.camera, iso_mesh_point_at(f.mesh, p), &u, &v));
        /* The weights are those of the image. On a slope, perspective shifts them a little. */
        double tolerance = i % 4 == 0 ? 1e-9 : 0.02;
        assert_true(hypot(u - 120.0 - column, v - 90.0 - row) < tolerance);
    }
    assert_true(found > 500 && found < 1800);
    tear_down(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_triangle_faces_the_camera_and_crosses_no_jump),
        cmocka_unit_test(adjacency_is_read_off_the_grid),
        cmocka_unit_test(the_largest_piece_alone_is_kept),
        cmocka_unit_test(places_are_found_where_they_are_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
