/** @file
 * A non-rigid shape made ready for description: one connected surface with its finite elements and
 * the lower end of its spectrum (Abdelrahman 2013, chapters 3 to 5).
 *
 * All descriptions are made of the heat kernel K(x, y, t) = sum_i exp(-lambda_i t) phi_i(x)
 * phi_i(y) of such a shape, with t as in heat_kernel.h (the dissertation's t is twice ours). A
 * shape may have any unit and any size. These are offline tools: their functions allocate memory at
 * every call. */
#ifndef ISOTHERM_SHAPE_H
#define ISOTHERM_SHAPE_H

#include <stdbool.h>

#include "isotherm/eigenpairs.h"
#include "isotherm/mesh.h"
#include "isotherm/stiffness_mass.h"

enum {
    ISO_CHANNELS = 3,              /**< Channels of a colour. */
    ISO_SHAPE_PAIRS = 100,         /**< Eigenpairs that suffice for every method. */
    ISO_SHAPE_WEIGHTED_PAIRS = 64, /**< Eigenpairs of each channel of a coloured shape. */
    ISO_SHAPE_VERTICES_MIN = 32,   /**< Least vertices of a shape. */
};

/** A colour. */
struct iso_colour {
    float channel[ISO_CHANNELS]; /**< Red, green, blue, each 0..1. */
};

/** The least density of a weighted manifold: heat could not flow at all where it is 0. */
#define ISO_SHAPE_DENSITY_MIN 0.05

/** A shape. It owns all it points to. Lengths are in the unit of the mesh that it was made of. */
struct iso_shape {
    struct iso_mesh *mesh;     /**< The largest component, without unused vertices. */
    struct iso_colour *colour; /**< [n_vertices], or NULL. */
    double *area;              /**< [n_vertices]: a third of the area of the triangles around. */
    double total_area;         /**< Area of the surface. */
    uint8_t *near_boundary;   /**< [n_vertices]: 1 on the boundary, or two edges or less from it. */
    int32_t *neighbour_start; /**< [n_vertices + 1]: where a vertex's neighbours begin. */
    int32_t *neighbour; /**< [neighbour_start[n_vertices]]: the vertices beside each vertex. */
    struct iso_symmetric *stiffness; /**< L of the finite elements. */
    struct iso_symmetric *mass;      /**< B of the finite elements. */
    struct iso_eigenpairs *pairs;    /**< [0] is the trivial pair: lambda 0, phi constant. */
    /** Of a shape with colours: ISO_SHAPE_WEIGHTED_PAIRS pairs on the manifold whose density is one
     * channel of them (Abdelrahman 2013, 5.2), at least ISO_SHAPE_DENSITY_MIN. */
    struct iso_eigenpairs *weighted[ISO_CHANNELS];
    bool is_cloud; /**< Made by iso_shape_new_cloud(). */
};

/** Makes a shape of a mesh, which may be as it comes:
 *
 *  - of several components (triangles joined by vertices) the one of the largest area is the shape;
 *  - vertices of no triangle and triangles without area are left out;
 *  - a boundary is insulated (Neumann); an edge of three or more triangles conducts into all.
 *
 * Any number of threads may call this at once.
 *
 * @param mesh     A mesh that iso_mesh_check() passes; what is needed of it is copied.
 * @param colour   [n_vertices]: a colour for each vertex of the mesh, or NULL.
 * @param n_pairs  Eigenpairs, the trivial one among them; 0: ISO_SHAPE_PAIRS. A shape too small for
 *                 so many has half as many as vertices.
 * @param out      Receives the shape; free it with iso_shape_free().
 * @return 0; -EINVAL, also for colours outside 0..1 or not finite; -ENODATA if fewer than
 *         ISO_SHAPE_VERTICES_MIN vertices are left; errors of iso_eigenpairs_new(). */
int iso_shape_new(const struct iso_mesh *mesh, const struct iso_colour *colour, int32_t n_pairs,
                  struct iso_shape **out) __attribute__((warn_unused_result));

/** Makes a shape of a bad mesh, as iso_shape_new(), but with the matrices of
 * iso_stiffness_mass_robust(), and eigenpairs of these. Triangles without area are kept if all
 * their corners belong to the shape: they close cracks within it, but do not join parts. `area` and
 * `neighbour` stay those of the mesh, and iso_geodesic_new() makes finite elements of its own of
 * the mesh as it is.
 *
 * @param mesh     As for iso_shape_new().
 * @param colour   As for iso_shape_new().
 * @param n_pairs  As for iso_shape_new().
 * @param out      Receives the shape; free it with iso_shape_free().
 * @return As iso_shape_new(); -ENOTRECOVERABLE also from iso_stiffness_mass_robust(). */
int iso_shape_new_robust(const struct iso_mesh *mesh, const struct iso_colour *colour,
                         int32_t n_pairs, struct iso_shape **out)
    __attribute__((warn_unused_result));

/** Makes a shape of a cloud: points of a surface without triangles, with the matrices of
 * iso_stiffness_mass_cloud() and eigenpairs of these. The triangles of iso_cloud_triangulate() join
 * the points; of several components the one of the largest area is the shape. In the shape,
 *
 *  - `mesh` has the points and those triangles, each once. Some of them overlap, and they have no
 *    common orientation;
 *  - `area` is the sum of a row of the mass matrix, and `total_area` the sum of all;
 *  - a point is on the boundary if its triangles do not close a ring.
 *
 * A point far from all others is not left out: it is joined to its nearest neighbours.
 *
 * @param point       [n]: the points, finite, in any unit.
 * @param colour      [n]: a colour for each point, or NULL.
 * @param n           How many.
 * @param neighbours  As for iso_cloud_triangulate(); 0: ISO_CLOUD_NEIGHBOURS.
 * @param n_pairs     As for iso_shape_new().
 * @param out         Receives the shape; free it with iso_shape_free().
 * @return As iso_shape_new_robust(); -EFBIG from iso_cloud_triangulate(). */
int iso_shape_new_cloud(const struct iso_vec3 *point, const struct iso_colour *colour, int32_t n,
                        int32_t neighbours, int32_t n_pairs, struct iso_shape **out)
    __attribute__((warn_unused_result));

/** Frees the colours of a shape and the pairs of its channels, which are most of the memory of a
 * shape with colours. Afterwards it is a shape without colours.
 *
 * @param shape  The shape; nobody else may use it meanwhile. */
void iso_shape_drop_colours(struct iso_shape *shape);

/** Frees a shape.
 *
 * @param shape  The shape, or NULL. */
void iso_shape_free(struct iso_shape *shape);

#endif
