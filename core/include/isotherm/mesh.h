/* A triangle mesh: the surface on which heat flows.
 *
 * Plain arrays, owned by the struct. Triangles are counter-clockwise seen from outside (for a depth
 * grid: from the camera). A mesh that is built again and again for frames is created once with its
 * largest size and refilled, so that nothing is allocated per frame. */
#ifndef ISOTHERM_MESH_H
#define ISOTHERM_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "isotherm/vec.h"

struct iso_mesh {
    int32_t n_vertices, n_triangles;
    int32_t vertex_capacity, triangle_capacity;
    struct iso_vec3 *vertices_mm; /* [n_vertices] */
    int32_t (*triangles)[3];      /* [n_triangles], indices of vertices */
};

/* A point on the surface: barycentric weights (>= 0, sum 1) over the corners of a triangle. */
struct iso_surface_point {
    int32_t triangle;
    double weight[3];
};

/* An empty mesh with room for the given counts (>= 1). -EINVAL, -ENOMEM. */
int iso_mesh_new(int32_t vertex_capacity, int32_t triangle_capacity, struct iso_mesh **out)
    __attribute__((warn_unused_result));
void iso_mesh_free(struct iso_mesh *mesh);

/* Makes room for at least so many, doubling, so that a mesh of unknown size can be built one by
 * one; not for frames. What is there stays. -ENOMEM. */
int iso_mesh_reserve(struct iso_mesh *mesh, int32_t n_vertices, int32_t n_triangles)
    __attribute__((warn_unused_result));

/* Every index in range, no triangle with a repeated corner, every coordinate finite; else -EINVAL
 * with *fault (if not NULL) set to a static text. */
int iso_mesh_check(const struct iso_mesh *mesh, const char **fault)
    __attribute__((warn_unused_result));

struct iso_vec3 iso_mesh_point_at(const struct iso_mesh *mesh, struct iso_surface_point point);
double iso_mesh_triangle_area(const struct iso_mesh *mesh, int32_t triangle);
double iso_mesh_area(const struct iso_mesh *mesh);

/* Neighbour across each edge: adjacent[t][k] is the triangle on the other side of the edge opposite
 * to corner k of triangle t, or -1 at the boundary. An edge of more than two triangles joins the
 * first two and counts as boundary for the rest. `adjacent` has room for n_triangles rows. -ENOMEM.
 */
int iso_mesh_adjacency(const struct iso_mesh *mesh, int32_t (*adjacent)[3])
    __attribute__((warn_unused_result));

/* Connected components over shared edges: component[t] for each triangle, numbered from 0 by
 * falling area. Returns how many there are, or -ENOMEM. */
int32_t iso_mesh_components(const struct iso_mesh *mesh, const int32_t (*adjacent)[3],
                            int32_t *component) __attribute__((warn_unused_result));

/* Marks boundary vertices: on_boundary[v] = 1 if v ends an edge that has one triangle only. */
void iso_mesh_boundary(const struct iso_mesh *mesh, const int32_t (*adjacent)[3],
                       uint8_t *on_boundary);

#endif
