/** @file
 * A depth frame becomes a triangle mesh.
 *
 * Each 2 x 2 cell of pixels gives two triangles along its shorter diagonal, or one triangle if only
 * three of its corners were measured. A triangle with an edge across a depth jump is left out.
 * Vertices are in the camera frame, row by row, one for each pixel that a triangle uses. Triangles
 * are counter-clockwise seen from the camera. */
#ifndef ISOTHERM_TRIANGULATE_H
#define ISOTHERM_TRIANGULATE_H

#include "isotherm/frame.h"
#include "isotherm/mesh.h"

/** Options of a triangulator. */
struct iso_triangulate_options {
    double jump_mm;    /**< An edge over which the depth changes by more is cut, mm; above 0. */
    bool largest_only; /**< Keep the largest connected piece only. */
};

/** The workspace of a triangulation. */
struct iso_triangulator;

/** Makes a triangulator.
 *
 * @param capacity_px  Most pixels of a frame.
 * @param options      The options; they are copied.
 * @param out          Receives the triangulator; free it with iso_triangulator_free().
 * @return 0; -EINVAL for options out of range; -ENOMEM. */
int iso_triangulator_new(size_t capacity_px, const struct iso_triangulate_options *options,
                         struct iso_triangulator **out) __attribute__((warn_unused_result));

/** Frees a triangulator.
 *
 * @param triangulator  The triangulator, or NULL. */
void iso_triangulator_free(struct iso_triangulator *triangulator);

/** Refills a mesh with the surface of a frame.
 *
 * @param triangulator  The triangulator.
 * @param frame         A frame that iso_frame_check() passes.
 * @param mesh          The mesh; room for one vertex and two triangles a pixel is enough.
 * @return 0; -ENODATA if there is no triangle; -ENOSPC if the frame or the mesh exceeds its
 *         capacity; -ENOMEM (only with largest_only, which allocates memory during the call). The
 *         mesh is empty after all these errors except for a frame that is too large. */
int iso_triangulate(struct iso_triangulator *triangulator, const struct iso_frame *frame,
                    struct iso_mesh *mesh) __attribute__((warn_unused_result));

/** The surface point of the mesh made last that is seen at a position of the frame.
 *
 * @param triangulator  The triangulator.
 * @param column        Column in the frame, pixels; fractions are allowed.
 * @param row           Row in the frame, pixels.
 * @param point         Receives the point on the surface.
 * @return 0; -ENOENT where there is no triangle. */
int iso_triangulate_locate(const struct iso_triangulator *triangulator, double column, double row,
                           struct iso_surface_point *point) __attribute__((warn_unused_result));

/** The neighbours of the triangles of the mesh made last: the same as iso_mesh_adjacency(), but
 * read off the grid and without allocating.
 *
 * @param triangulator  The triangulator.
 * @param adjacent      [n_triangles][3]: receives at [t][k] the triangle across the edge opposite
 * to corner k of triangle t, or -1. */
void iso_triangulate_adjacency(const struct iso_triangulator *triangulator, int32_t (*adjacent)[3]);

#endif
