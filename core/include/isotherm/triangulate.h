/* A depth frame becomes a triangle mesh.
 *
 * Each 2 x 2 cell of pixels gives two triangles along its shorter diagonal, or one if only three of
 * its corners were measured. A triangle with an edge across a depth jump is left out. Vertices are
 * in the frame's camera coordinates, row by row, one for each pixel that a triangle uses; triangles
 * are counter-clockwise seen from the camera. */
#ifndef ISOTHERM_TRIANGULATE_H
#define ISOTHERM_TRIANGULATE_H

#include "isotherm/frame.h"
#include "isotherm/mesh.h"

struct iso_triangulate_options {
    double jump_mm;    /* an edge over which the depth changes by more is cut; > 0 */
    bool largest_only; /* keep the largest connected piece only */
};

/* Workspace for frames of up to capacity_px pixels. */
struct iso_triangulator;
int iso_triangulator_new(size_t capacity_px, const struct iso_triangulate_options *options,
                         struct iso_triangulator **out) __attribute__((warn_unused_result));
void iso_triangulator_free(struct iso_triangulator *triangulator);

/* Refills `mesh`. -ENODATA if no triangle results (the mesh is then empty), -ENOSPC if the frame or
 * the mesh exceeds its capacity, -ENOMEM (with largest_only, which allocates for a moment). */
int iso_triangulate(struct iso_triangulator *triangulator, const struct iso_frame *frame,
                    struct iso_mesh *mesh) __attribute__((warn_unused_result));

/* The surface point of the mesh made last that is seen at a pixel position of the frame (fractions
 * allowed). -ENOENT where there is no triangle. */
int iso_triangulate_locate(const struct iso_triangulator *triangulator, double column, double row,
                           struct iso_surface_point *point) __attribute__((warn_unused_result));

/* Neighbours across the edges of the mesh made last: what iso_mesh_adjacency gives, but read off
 * the grid and without allocating. adjacent[t][k] is the triangle across the edge opposite to
 * corner k of triangle t, or -1. */
void iso_triangulate_adjacency(const struct iso_triangulator *triangulator, int32_t (*adjacent)[3]);

#endif
