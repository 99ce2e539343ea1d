/** @file
 * A triangle mesh: the surface on which heat flows.
 *
 * Plain arrays that the struct owns. Triangles are counter-clockwise seen from outside (for a depth
 * grid: from the camera). A mesh that is built again for every frame is created once with its
 * largest size and refilled, so that nothing is allocated per frame. */
#ifndef ISOTHERM_MESH_H
#define ISOTHERM_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "isotherm/fault.h"
#include "isotherm/vec.h"

/** A triangle mesh. The caller fills in the arrays and the counts. */
struct iso_mesh {
    int32_t n_vertices;           /**< Vertices in use. */
    int32_t n_triangles;          /**< Triangles in use. */
    int32_t vertex_capacity;      /**< Vertices that there is room for. */
    int32_t triangle_capacity;    /**< Triangles that there is room for. */
    struct iso_vec3 *vertices_mm; /**< [n_vertices]: positions, millimetres. */
    int32_t (*triangles)[3];      /**< [n_triangles]: indices of vertices. */
};

/** A point on the surface of a mesh. */
struct iso_surface_point {
    int32_t triangle; /**< Index of the triangle. */
    double weight[3]; /**< Barycentric weights of its corners: at least 0, sum 1. */
};

/** Makes an empty mesh.
 *
 * @param vertex_capacity    Room for so many vertices, at least 1.
 * @param triangle_capacity  Room for so many triangles, at least 1.
 * @param out                Receives the mesh; free it with iso_mesh_free().
 * @return 0; -EINVAL; -ENOMEM. */
int iso_mesh_new(int32_t vertex_capacity, int32_t triangle_capacity, struct iso_mesh **out)
    __attribute__((warn_unused_result));

/** Frees a mesh.
 *
 * @param mesh  The mesh, or NULL. */
void iso_mesh_free(struct iso_mesh *mesh);

/** Makes room for at least so many vertices and triangles. The room at least doubles each time it
 * grows, so that a mesh of unknown size can be built triangle by triangle. The contents stay. The
 * function allocates memory: do not call it for every frame.
 *
 * @param mesh         The mesh; its arrays may move.
 * @param n_vertices   Vertices that there shall be room for.
 * @param n_triangles  Triangles that there shall be room for.
 * @return 0; -ENOMEM. */
int iso_mesh_reserve(struct iso_mesh *mesh, int32_t n_vertices, int32_t n_triangles)
    __attribute__((warn_unused_result));

/** Checks that every index is in range, no triangle repeats a corner, and every coordinate is
 * finite.
 *
 * @param mesh   The mesh.
 * @param fault  If not NULL: on failure, receives a text that says what is wrong.
 * @return 0, or -EINVAL. */
int iso_mesh_check(const struct iso_mesh *mesh, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/** Where a point of the surface lies.
 *
 * @param mesh   The mesh.
 * @param point  The point on the surface.
 * @return Its position, millimetres. */
struct iso_vec3 iso_mesh_point_at(const struct iso_mesh *mesh, struct iso_surface_point point);

/** Area of a triangle.
 *
 * @param mesh      The mesh.
 * @param triangle  Index of the triangle.
 * @return The area, mm^2. */
double iso_mesh_triangle_area(const struct iso_mesh *mesh, int32_t triangle);

/** Area of all triangles.
 *
 * @param mesh  The mesh.
 * @return The area, mm^2. */
double iso_mesh_area(const struct iso_mesh *mesh);

/** Finds the neighbour of each triangle across each of its edges. An edge of more than two
 * triangles joins the first two and counts as boundary for the rest.
 *
 * @param mesh      The mesh.
 * @param adjacent  [n_triangles][3]: receives at [t][k] the triangle across the edge opposite to
 *                  corner k of triangle t, or -1 at the boundary.
 * @return 0; -ENOMEM. */
int iso_mesh_adjacency(const struct iso_mesh *mesh, int32_t (*adjacent)[3])
    __attribute__((warn_unused_result));

/** Finds the connected components over shared edges, numbered from 0 by falling area.
 *
 * @param mesh       The mesh.
 * @param adjacent   [n_triangles][3]: from iso_mesh_adjacency().
 * @param component  [n_triangles]: receives the number of each triangle's component.
 * @return How many components there are; -ENOMEM. */
int32_t iso_mesh_components(const struct iso_mesh *mesh, const int32_t (*adjacent)[3],
                            int32_t *component) __attribute__((warn_unused_result));

/** Marks the vertices of the boundary.
 *
 * @param mesh         The mesh.
 * @param adjacent     [n_triangles][3]: from iso_mesh_adjacency().
 * @param on_boundary  [n_vertices]: receives 1 for both ends of every edge across which a triangle
 *                     has no neighbour (-1 in `adjacent`), else 0. */
void iso_mesh_boundary(const struct iso_mesh *mesh, const int32_t (*adjacent)[3],
                       uint8_t *on_boundary);

#endif
