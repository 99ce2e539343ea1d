#include "tests/core/surfaces/grid_surface.h"
#include "tests/core/surfaces/shipped_model.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/surface/face_patch.h"
#include "core/surface/raster.h"
#include "isotherm/head_model.h"

enum { COLUMNS = 75, ROWS = 58 };

static const double jump_mm = 40.0;

static struct iso_frame *new_frame(int columns, int rows, double pitch_mm)
{
    const struct iso_camera camera = {.projection = ISO_ORTHOGRAPHIC,
                                      .width_px = columns,
                                      .height_px = rows,
                                      .pitch_mm = pitch_mm,
                                      .cx_px = columns / 2,
                                      .cy_px = rows / 2};
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, columns, rows, false, &frame), 0);
    return frame;
}

static struct grid_surface surface_of(struct iso_frame *frame)
{
    struct grid_surface s = {.frame = frame};
    int n_px = frame->width_px * frame->height_px;
    const struct iso_triangulate_options options = {.jump_mm = jump_mm};
    assert_int_equal(iso_grid_new(frame->width_px, frame->height_px, &s.grid), 0);
    assert_int_equal(iso_grid_build(s.grid, frame, jump_mm), 0);
    assert_int_equal(iso_triangulator_new((size_t)n_px, &options, &s.triangulator), 0);
    assert_int_equal(iso_mesh_new(n_px, 2 * n_px, &s.mesh), 0);
    assert_int_equal(iso_triangulate(s.triangulator, frame, s.mesh), 0);
    s.adjacent = calloc((size_t)s.mesh->n_triangles, sizeof *s.adjacent);
    s.plane_index = calloc((size_t)s.mesh->n_vertices, sizeof *s.plane_index);
    assert_true(s.adjacent && s.plane_index);
    iso_triangulate_adjacency(s.triangulator, s.adjacent);
    for (int32_t i = 0; i < s.mesh->n_vertices; i++) {
        struct iso_vec3 p = s.mesh->vertices_mm[i];
        int column = (int)lround(p.x / s.grid->pitch_mm + s.grid->cx_px);
        int row = (int)lround(p.y / s.grid->pitch_mm + s.grid->cy_px);
        s.plane_index[i] = row * s.grid->stride + column;
        s.mesh->vertices_mm[i] = iso_face_from_patch(p);
    }
    return s;
}

struct grid_surface grid_surface_hills(double pitch_mm, double steepness)
{
    struct iso_frame *frame = new_frame(COLUMNS, ROWS, pitch_mm);
    for (int row = 0; row < ROWS; row++) {
        for (int column = 0; column < COLUMNS; column++) {
            double x = pitch_mm * (column - COLUMNS / 2), y = pitch_mm * (row - ROWS / 2);
            double z = 220.0 +
                       steepness * (9.0 * sin(0.11 * x + 0.3) * cos(0.09 * y) +
                                    4.0 * sin(0.23 * x - 0.19 * y) + 0.2 * sin(7.0 * x * y + x));
            frame->depth_mm[row * COLUMNS + column] = (float)z;
        }
    }
    if (steepness > 0.0) {
        const int holes[][2] = {{40, 20}, {41, 22}, {10, 50}, {0, 0}, {74, 57}, {2, 1}, {60, 57}};
        for (size_t i = 0; i < sizeof holes / sizeof holes[0]; i++) {
            frame->depth_mm[holes[i][1] * COLUMNS + holes[i][0]] = 0.0f;
        }
        for (int row = 30; row < 39; row++) {
            for (int column = 55; column < 66; column++) {
                bool cliff = column < 62;
                frame->depth_mm[row * COLUMNS + column] =
                    cliff ? 0.0f : frame->depth_mm[row * COLUMNS + column] + 60.0f;
            }
        }
    }
    return surface_of(frame);
}

struct grid_surface grid_surface_mean_face(double pitch_mm)
{
    struct iso_head_model *model = shipped_head_model();
    int side = 2 * (int)ceil(100.0 / pitch_mm) + 1;
    struct iso_frame *frame = new_frame(side, side, pitch_mm);
    const struct iso_raster raster = {
        .camera = frame->camera, .width_px = side, .height_px = side, .depth_mm = frame->depth_mm};
    struct iso_vec3 *seen = calloc(model->n_vertices, sizeof *seen);
    assert_non_null(seen);
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        seen[i] = iso_patch_from_face(model->mean_mm[i]);
    }
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, seen, (const uint32_t(*)[3])model->triangles,
                         (int32_t)model->n_triangles, 0, 1.0, 1);
    free(seen);
    iso_head_model_free(model);
    for (int i = 0; i < side * side; i++) {
        if (hypot(i % side - side / 2, i / side - side / 2) * pitch_mm > 100.0) {
            frame->depth_mm[i] = 0.0f;
        }
    }
    return surface_of(frame);
}

void grid_surface_done(struct grid_surface *surface)
{
    iso_frame_free(surface->frame);
    iso_grid_free(surface->grid);
    iso_triangulator_free(surface->triangulator);
    iso_mesh_free(surface->mesh);
    free(surface->adjacent);
    free(surface->plane_index);
}

struct iso_grid_point grid_surface_point(const struct grid_surface *s, double x_mm, double y_mm)
{
    struct iso_grid_point point;
    assert_int_equal(iso_grid_locate(s->grid, s->grid->cx_px + x_mm / s->grid->pitch_mm,
                                     s->grid->cy_px - y_mm / s->grid->pitch_mm, &point),
                     0);
    return point;
}

struct iso_surface_point grid_surface_mesh_point(const struct grid_surface *s, double x_mm,
                                                 double y_mm)
{
    struct iso_surface_point point;
    assert_int_equal(iso_triangulate_locate(s->triangulator,
                                            s->grid->cx_px + x_mm / s->grid->pitch_mm,
                                            s->grid->cy_px - y_mm / s->grid->pitch_mm, &point),
                     0);
    return point;
}

double *grid_surface_on_mesh(const struct grid_surface *s, const struct iso_grid_field *field)
{
    double *value = calloc((size_t)s->mesh->n_vertices, sizeof *value);
    assert_non_null(value);
    for (int32_t i = 0; i < s->mesh->n_vertices; i++) {
        value[i] = (double)field->value[s->plane_index[i]];
    }
    return value;
}
