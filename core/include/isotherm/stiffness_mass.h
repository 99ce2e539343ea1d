/** @file
 * Linear finite elements on a triangle mesh: the stiffness matrix L and the mass matrix B.
 *
 * L(i,j) = -(cot a_ij + cot b_ij) / 2 off the diagonal, and minus the row's sum on it. L is
 * symmetric positive semi-definite; a constant is its null vector, and the boundary is a natural
 * (Neumann) one. B consistent: (|t_r| + |t_s|) / 12 off the diagonal, the sum of incident |t| / 6
 * on it. B lumped: the sum of incident |t| / 3. Source: Abdelrahman 2013, eqs. 3.33 and 3.34 with
 * the signs put right (the text's 3.34 is -L, and its diagonal of 3.33 sums over incident
 * triangles). L has no unit, B is in mm^2. */
#ifndef ISOTHERM_STIFFNESS_MASS_H
#define ISOTHERM_STIFFNESS_MASS_H

#include <stdint.h>

#include "isotherm/mesh.h"

/** A symmetric sparse matrix in compressed columns: the lower triangle only, the diagonal first in
 * each column, rows ascending. It owns its arrays. */
struct iso_symmetric {
    int32_t n;             /**< Order. */
    int32_t nnz;           /**< Entries that are stored. */
    int32_t n_capacity;    /**< Order that there is room for. */
    int32_t nnz_capacity;  /**< Entries that there is room for. */
    int32_t *column_start; /**< [n + 1]: where each column begins. */
    int32_t *row;          /**< [nnz]: row of each entry. */
    double *value;         /**< [nnz]: the entries. */
};

/** A kind of mass matrix. */
enum iso_mass {
    ISO_MASS_CONSISTENT, /**< As the finite elements have it. */
    ISO_MASS_LUMPED, /**< Diagonal; stored in the stiffness's pattern, zeros off the diagonal. */
};

/** Makes an empty matrix.
 *
 * @param n_capacity    Room for this order.
 * @param nnz_capacity  Room for so many entries: n_vertices + 3 n_triangles are enough for a mesh.
 * @param out           Receives the matrix; free it with iso_symmetric_free().
 * @return 0; -EINVAL; -ENOMEM. */
int iso_symmetric_new(int32_t n_capacity, int32_t nnz_capacity, struct iso_symmetric **out);

/** Frees a matrix.
 *
 * @param matrix  The matrix, or NULL. */
void iso_symmetric_free(struct iso_symmetric *matrix);

/** Multiplies a vector by the whole symmetric matrix.
 *
 * @param a  The matrix.
 * @param x  [n]: the vector.
 * @param y  [n]: receives A x; it may not overlap x. */
void iso_symmetric_multiply(const struct iso_symmetric *a, const double *x, double *y);

/** Assembles both matrices, which share one pattern. A degenerate triangle (area below 1e-12 of its
 * longest edge squared) adds nothing. Vertices in no triangle get an empty row of L and a unit
 * mass, so that both matrices can be factorised.
 *
 * @param mesh       The mesh.
 * @param kind       The kind of mass matrix.
 * @param stiffness  Is refilled with L.
 * @param mass       Is refilled with B, mm^2.
 * @return 0; -EINVAL for a mesh that is empty or that iso_mesh_check() refuses; -ENOSPC if a matrix
 *         has too little room. */
int iso_stiffness_mass(const struct iso_mesh *mesh, enum iso_mass kind,
                       struct iso_symmetric *stiffness, struct iso_symmetric *mass)
    __attribute__((warn_unused_result));

/** Assembles both matrices of a weighted manifold: both integrals are taken with a density h > 0
 * that is given at the vertices and linear between them (Abdelrahman 2013, 5.11 to 5.13, with the
 * diagonal of 5.13 as the negative sum of its row). A density of 1 gives the matrices of
 * iso_stiffness_mass(). The matrices stay symmetric and positive (semi-)definite, and a constant
 * stays a null vector of L. Heat flows as dU/dt = (1/h) div(h grad U): it is kept within what is
 * dense.
 *
 * @param mesh       The mesh.
 * @param kind       The kind of mass matrix.
 * @param density    [n_vertices]: the density, above 0 and finite.
 * @param stiffness  Is refilled with L.
 * @param mass       Is refilled with B, mm^2.
 * @return As iso_stiffness_mass(); -EINVAL also for a density out of range. */
int iso_stiffness_mass_weighted(const struct iso_mesh *mesh, enum iso_mass kind,
                                const double *density, struct iso_symmetric *stiffness,
                                struct iso_symmetric *mass) __attribute__((warn_unused_result));

/** Assembles both matrices on the intrinsic Delaunay triangulation of the mesh's tufted cover
 * (Sharp and Crane, "A Laplacian for nonmanifold triangle meshes", Computer Graphics Forum 39(5),
 * 2020). It is for bad meshes: triangles may be slivers or have no area, edges may have any number
 * of triangles, and triangles need not agree on which side is the outside.
 *
 * Without a density no conductance between two vertices is negative, except by rounding. With a
 * lumped mass, heat therefore stays between its extremes. If the mesh is a closed manifold and all
 * its edges are Delaunay, the matrices are those of iso_stiffness_mass(). A vertex on the boundary
 * may be joined to vertices with which it shares no edge of the mesh. If a triangle is nearly flat,
 * the function makes all edges longer, by up to 1e-5 of their mean length.
 *
 * @param mesh       The mesh.
 * @param kind       The kind of mass matrix.
 * @param density    [n_vertices]: as for iso_stiffness_mass_weighted(), or NULL: 1 everywhere.
 * @param stiffness  Is refilled with L; n_vertices + 3 n_triangles entries are enough.
 * @param mass       Is refilled with B, mm^2.
 * @return As iso_stiffness_mass_weighted(). -EINVAL also if the mesh has no triangle, or if all its
 *         edges have the length 0. -ENOTRECOVERABLE if the triangulation is not Delaunay after 600
 *         flips for each triangle of the mesh. -ENOMEM, because this function allocates memory. */
int iso_stiffness_mass_robust(const struct iso_mesh *mesh, enum iso_mass kind,
                              const double *density, struct iso_symmetric *stiffness,
                              struct iso_symmetric *mass) __attribute__((warn_unused_result));

enum {
    ISO_CLOUD_NEIGHBOURS = 30,      /**< Neighbours of a point of a cloud, as a rule. */
    ISO_CLOUD_NEIGHBOURS_MIN = 6,   /**< The least number of them. */
    ISO_CLOUD_NEIGHBOURS_MAX = 200, /**< The largest one. */
};

/** Finds triangles of a cloud: points of a surface of which nothing else is known (Sharp and Crane
 * 2020, section 5.7). For each point, the nearest neighbours are projected into the plane that is
 * nearest to them, and the triangles around the point in their Delaunay triangulation are taken. A
 * triangle on which all three corners agree is therefore there three times. All triangles together
 * are not a surface that a program could draw or walk on, but iso_stiffness_mass_cloud() makes good
 * matrices of them.
 *
 * Four points on one circle have two triangulations. Small weights of the points (1e-6 squares of
 * the distance to the nearest point), which depend on their numbers, decide in the same way for all
 * four. Of several points at exactly the same place the first one is used. In the result the
 * triangles of each point, which is their first corner, are together, in their order around it;
 * triangles of different points need not have the same orientation.
 *
 * @param point       [n]: the points, finite.
 * @param n           How many.
 * @param neighbours  How many neighbours of each point are looked at; 0: ISO_CLOUD_NEIGHBOURS.
 * @param out         Receives a mesh of the same points; free it with iso_mesh_free().
 * @return 0; -EINVAL if there is no point, if one is not finite, or for a number of neighbours out
 *         of range; -EFBIG for more than INT32_MAX / 12 triangles; -ENOMEM. */
int iso_cloud_triangulate(const struct iso_vec3 *point, int32_t n, int32_t neighbours,
                          struct iso_mesh **out) __attribute__((warn_unused_result));

/** Assembles both matrices of a cloud: a third of those of iso_stiffness_mass_robust(), because
 * triangles are there three times. No conductance is negative. Where the surface ends it is
 * insulated.
 *
 * @param cloud      Of iso_cloud_triangulate(); all its triangles.
 * @param kind       The kind of mass matrix.
 * @param density    [n_vertices]: as for iso_stiffness_mass_weighted(), or NULL: 1 everywhere.
 * @param stiffness  Is refilled with L; n_vertices + 3 n_triangles entries are enough.
 * @param mass       Is refilled with B, the square of the points' unit.
 * @return As iso_stiffness_mass_robust(). */
int iso_stiffness_mass_cloud(const struct iso_mesh *cloud, enum iso_mass kind,
                             const double *density, struct iso_symmetric *stiffness,
                             struct iso_symmetric *mass) __attribute__((warn_unused_result));

#endif
