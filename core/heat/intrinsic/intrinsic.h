/* A surface that is known by the lengths of its edges alone: an intrinsic triangulation. Its edges
 * are straight in the surface, not in space, so they can be exchanged without changing the surface.
 *
 * The surface that is made here is the tufted cover of a mesh (Sharp and Crane, "A Laplacian for
 * nonmanifold triangle meshes", Computer Graphics Forum 39(5), 2020): each triangle has two sides,
 * and each side is a triangle of the cover. Around an edge of any number of triangles, each side is
 * joined to the one that faces it; copies of a triangle are in sheets of their own. For every
 * mesh the cover is closed and oriented, and each of its edges has two triangles at most. It covers
 * the surface twice. */
#ifndef ISO_CORE_HEAT_INTRINSIC_INTRINSIC_H
#define ISO_CORE_HEAT_INTRINSIC_INTRINSIC_H

#include "isotherm/mesh.h"

/* A triangle has three sides. Side 3 t + k belongs to triangle t, begins at its corner k, and ends
 * at the next corner of t. An edge consists of two sides, one of each triangle that it joins. */
struct iso_intrinsic {
    int32_t n_triangles, n_sides; /* 3 n_triangles */
    int32_t *corner;              /* [n_sides]: the vertex where a side begins */
    double *length;               /* [n_sides] */
    int32_t *across;              /* [n_sides]: the other side of the same edge */
};

/* Makes the tufted cover of a mesh that iso_mesh_check() passes. All edges become longer by the
 * same length, which is 0 unless a triangle is nearly flat: then it is the least one with which the
 * triangle inequality holds by a margin of 1e-5 mean edges (intrinsic mollification, ibid.).
 * -EINVAL if the mesh has no triangle, if it has more than INT32_MAX / 12 triangles, or if all its
 * edges have the length 0; -ENOMEM. */
int iso_intrinsic_cover(const struct iso_mesh *mesh, struct iso_intrinsic *out)
    __attribute__((warn_unused_result));

/* Flips edges until all are Delaunay: the cotangents of the two angles opposite to an edge have a
 * sum of at least 0, up to rounding. *n_flips receives how many edges were flipped.
 * -ENOTRECOVERABLE if that takes more than 100 flips for each side, -ENOMEM. */
int iso_intrinsic_delaunay(struct iso_intrinsic *surface, int64_t *n_flips)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_intrinsic_done(struct iso_intrinsic *surface);

/* The side after this one in its triangle. */
static inline int32_t iso_side_next(int32_t side)
{
    return side / 3 * 3 + (side + 1) % 3;
}

/* Area of a triangle (Heron's formula as Kahan evaluates it, so that it is accurate for slivers).
 */
double iso_intrinsic_area(const struct iso_intrinsic *surface, int32_t triangle);

/* Cotangent of the angle opposite to a side; 0 in a triangle without area. */
double iso_intrinsic_cotangent(const struct iso_intrinsic *surface, int32_t side);

#endif
