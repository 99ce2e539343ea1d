/* A surface kept as planes of an orthographic depth grid: the triangles that iso_triangulate would
 * make of the same frame, without a mesh, for the fast way from patch to isotherms.
 *
 * Every plane has the grid's layout: pixel (column, row) at plane[row * stride + column]; row -1,
 * row `height`, and at least one column to the left and right are there too and hold 0, so that a
 * pixel's neighbours can be read without asking. Planes are pointers to pixel (0, 0), each row's
 * first pixel aligned for vectors. Points are in
 * the face frame, as iso_face_from_patch gives them. */
#ifndef ISO_CORE_SURFACE_GRID_H
#define ISO_CORE_SURFACE_GRID_H

#include "core/surface/cell.h"
#include "isotherm/frame.h"
#include "isotherm/mesh.h"

struct iso_grid {
    int width, height, stride; /* pixels */
    double pitch_mm;
    double cx_px, cy_px; /* where x = y = 0 */
    float *z_mm;         /* height of each pixel in the face frame */
    float *cell_mm2[4];  /* in the cell right and below of the pixel, area of the triangle that
                            leaves  out corner k (cell.h); 0: there is none */
    float *share_mm2;    /* a third of the area of all triangles at the pixel; 0: no vertex */
    uint8_t *cell;       /* set of the cell's triangles */
    float *memory;       /* of the planes of floats */
};

/* A rectangle of pixels. */
struct iso_grid_window {
    int column, row, width, height;
};

/* Values at the vertices of a window, 0 elsewhere: a plane in the grid's layout. The window may end
 * in the margin on the right, where there are no vertices. */
struct iso_grid_field {
    struct iso_grid_window window;
    const float *value;
};

/* A point on a triangle of the grid: plane indices of its corners and their weights (>= 0, sum 1).
 */
struct iso_grid_point {
    int32_t corner[3];
    double weight[3];
};

/* Room for grids of one size, at most 2048 pixels a side. -EINVAL, -ENOMEM. */
int iso_grid_new(int width_px, int height_px, struct iso_grid **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_grid_free(struct iso_grid *grid);

/* Floats of one plane with its margins, a multiple of 16, and how far pixel (0, 0) lies from its
 * begin: for planes of the same layout. */
size_t iso_grid_plane_size(const struct iso_grid *grid);
size_t iso_grid_plane_origin(const struct iso_grid *grid);

/* So many zeroed planes of the grid's layout, one after the other, from iso_grid_plane_size to
 * size, aligned to 64 bytes. NULL if there is no memory. iso_grid_planes_free wipes them first. */
float *iso_grid_planes_new(const struct iso_grid *grid, int n_planes);

/* Wipes and frees it. NULL is accepted. */
void iso_grid_planes_free(float *planes, size_t plane_size, int n_planes);

/* Takes over the surface of a frame. An edge across a change of depth of more than jump_mm is cut.
 * -EINVAL if the frame is not orthographic or not of the grid's size, -ENODATA if there is no
 * triangle. */
int iso_grid_build(struct iso_grid *grid, const struct iso_frame *frame, double jump_mm)
    __attribute__((warn_unused_result));

/* The surface point seen at a pixel position (fractions allowed); -ENOENT where there is none. */
int iso_grid_locate(const struct iso_grid *grid, double column, double row,
                    struct iso_grid_point *point) __attribute__((warn_unused_result));

struct iso_vec3 iso_grid_vertex(const struct iso_grid *grid, int32_t index);
struct iso_vec3 iso_grid_point_at(const struct iso_grid *grid, const struct iso_grid_point *point);

/* Plane index of a corner of the cell at a plane index. */
static inline int32_t iso_grid_corner(const struct iso_grid *grid, int32_t cell, int corner)
{
    return cell + (corner & 1) + (corner >> 1) * grid->stride;
}

#endif
