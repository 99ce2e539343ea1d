/* A non-rigid shape, prepared for description: one connected surface with its finite elements and
 * the lower end of its spectrum.
 *
 * Everything of this folder is made of the heat kernel K(x, y, t) = sum_i exp(-lambda_i t)
 * phi_i(x) phi_i(y) of such a shape, t as in isotherm/heat_kernel.h (the dissertation's t is twice
 * ours). A shape may have any unit and any size. These are offline tools: functions allocate. */
#ifndef ISOTHERM_SHAPE_H
#define ISOTHERM_SHAPE_H

#include "isotherm/eigenpairs.h"
#include "isotherm/mesh.h"
#include "isotherm/stiffness_mass.h"

enum {
    ISO_CHANNELS = 3,
    ISO_SHAPE_PAIRS = 100, /* enough eigenpairs for every method */
    ISO_SHAPE_WEIGHTED_PAIRS = 64,
    ISO_SHAPE_VERTICES_MIN = 32,
};

/* A colour: red, green, blue, each 0..1. */
struct iso_colour {
    float channel[ISO_CHANNELS];
};

#define ISO_SHAPE_DENSITY_MIN 0.05

struct iso_shape {
    struct iso_mesh *mesh;     /* the largest part of what was given, unused vertices left out */
    struct iso_colour *colour; /* [n_vertices], or NULL */
    double *area;              /* [n_vertices]: a third of the triangles around; in square units */
    double total_area;
    uint8_t *near_boundary; /* [n_vertices]: on the boundary, or two edges or less from it */
    /* Neighbours of vertex v: neighbour[neighbour_start[v] .. neighbour_start[v + 1] - 1]. */
    int32_t *neighbour_start, *neighbour;
    struct iso_symmetric *stiffness, *mass;
    struct iso_eigenpairs *pairs; /* [0] is the trivial one: lambda 0, phi constant */
    /* Of a shape with colours: ISO_SHAPE_WEIGHTED_PAIRS pairs on the manifold whose density is one
     * channel of them (Abdelrahman 2013, 5.2), at least ISO_SHAPE_DENSITY_MIN, since heat could not
     * flow at all where it is 0. */
    struct iso_eigenpairs *weighted[ISO_CHANNELS];
};

/* Copies what it needs of the mesh, which iso_mesh_check passes, and of a colour for each of its
 * vertices (NULL: none; values outside 0..1 or not finite are -EINVAL). Meshes as they come:
 *
 *  - of several components (triangles joined by vertices) the one of the largest area is the shape;
 *  - vertices of no triangle and triangles without area are left out;
 *  - a boundary is insulated (Neumann); an edge of three or more triangles conducts into all.
 *
 * `n_pairs` eigenpairs are computed, the trivial one among them; 0 means ISO_SHAPE_PAIRS. A shape
 * too small for so many has fewer: half as many as vertices. -EINVAL; -ENODATA if fewer than
 * ISO_SHAPE_VERTICES_MIN vertices are left; errors of iso_eigenpairs_new. Thread-safe. */
int iso_shape_new(const struct iso_mesh *mesh, const struct iso_colour *colour, int32_t n_pairs,
                  struct iso_shape **out) __attribute__((warn_unused_result));
void iso_shape_free(struct iso_shape *shape);

#endif
