/* A surface stored as planes of an orthographic depth grid, without a mesh: the fast way from the
 * face patch to the isotherms. It has the same triangles that iso_triangulate would make of the
 * same frame.
 *
 * Every plane has the grid's layout: pixel (column, row) is at plane[row * stride + column]. Planes
 * also have row -1, row `height` and at least one column to the left and to the right. These
 * margins hold 0, so that the neighbours of a pixel can be read without a check. A plane is a
 * pointer to pixel (0, 0). The first pixel of each row is aligned for vectors. Points are in the
 * face frame, as iso_face_from_patch gives them. */
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
    float *cell_mm2[4];  /* [k]: the area of the triangle that leaves out corner k (cell.h), in the
                            cell with the pixel as its upper left corner; 0: no such triangle */
    float *share_mm2;    /* a third of the area of all triangles at the pixel; 0: no vertex */
    uint8_t *cell;       /* the set of the triangles of the same cell (cell.h) */
    float *memory;       /* the memory of all planes of floats */
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

/* A point on a triangle of the grid: plane indices of the corners and their weights (>= 0, sum 1).
 */
struct iso_grid_point {
    int32_t corner[3];
    double weight[3];
};

/* Makes a grid for frames of one size, 2..2048 pixels a side. -EINVAL, -ENOMEM. */
int iso_grid_new(int width_px, int height_px, struct iso_grid **out)
    __attribute__((warn_unused_result));

/* Wipes the planes and frees the grid. NULL is accepted. */
void iso_grid_free(struct iso_grid *grid);

/* How many floats a plane with its margins has: a multiple of 16. */
size_t iso_grid_plane_size(const struct iso_grid *grid);

/* The index of pixel (0, 0) in a plane with its margins. */
size_t iso_grid_plane_origin(const struct iso_grid *grid);

/* Allocates n_planes planes of zeros in the grid's layout. They follow each other, each of
 * iso_grid_plane_size floats, and are aligned to 64 bytes. NULL if there is no memory. */
float *iso_grid_planes_new(const struct iso_grid *grid, int n_planes);

/* Wipes and frees planes of iso_grid_planes_new. plane_size: that of iso_grid_plane_size. NULL is
 * accepted. */
void iso_grid_planes_free(float *planes, size_t plane_size, int n_planes);

/* Refills the grid with the surface of a frame. A triangle that spans more than jump_mm of depth is
 * left out. -EINVAL if the frame is not orthographic or not of the grid's size, -ENODATA if there
 * is no triangle. */
int iso_grid_build(struct iso_grid *grid, const struct iso_frame *frame, double jump_mm)
    __attribute__((warn_unused_result));

/* The surface point seen at a pixel position (fractions allowed); -ENOENT where there is none. */
int iso_grid_locate(const struct iso_grid *grid, double column, double row,
                    struct iso_grid_point *point) __attribute__((warn_unused_result));

/* The position of the vertex at a plane index, face frame, mm. */
struct iso_vec3 iso_grid_vertex(const struct iso_grid *grid, int32_t index);

/* The position of a point on the surface, face frame, mm. */
struct iso_vec3 iso_grid_point_at(const struct iso_grid *grid, const struct iso_grid_point *point);

/* The plane index of a corner (0..3) of the cell whose upper left corner has the index `cell`. */
static inline int32_t iso_grid_corner(const struct iso_grid *grid, int32_t cell, int corner)
{
    return cell + (corner & 1) + (corner >> 1) * grid->stride;
}

#endif
