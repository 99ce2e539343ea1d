/* Coarsens meshes by half-edge collapse with quadric error metrics (Garland and Heckbert 1997).
 * A vertex is merged into a neighbour, so that the remaining vertices are original ones and keep
 * their data (modes of a morphable model). */
#ifndef SIM_TRAIN_HEAD_DECIMATE_H
#define SIM_TRAIN_HEAD_DECIMATE_H

#include <stdint.h>

#include "isotherm/vec.h"

enum { SIM_DECIMATE_FAN_LIMIT = 512 };

struct sim_decimate_options {
    uint32_t n_target;        /* stop at this number of vertices */
    const uint8_t *keep;      /* [n_vertices], 1: the vertex is never merged away; NULL: none */
    const double *importance; /* [n_vertices], > 0, weight of an error at the vertex; NULL: 1 */
    uint32_t fan_max;         /* most triangles that a vertex may have at the beginning, at most
                               * SIM_DECIMATE_FAN_LIMIT; 0: 24 */
};

/* Merges vertices until n_target of them have triangles, or until no merge is allowed. A merge
 * must not flip a triangle, make a sliver, change the topology or move the boundary (a boundary
 * vertex only moves along it). It must not give a vertex more than 24 triangles. `triangles` is
 * changed in place and *n_triangles is reduced. Vertices keep their places; some have no triangles
 * afterwards. The result is deterministic: among equal costs the lowest vertex goes first. -EINVAL
 * for a triangle out of range or a vertex with more than fan_max triangles; -ENOMEM. */
int sim_decimate(const struct iso_vec3 *vertices_mm, uint32_t n_vertices,
                 const struct sim_decimate_options *options, uint32_t (*triangles)[3],
                 uint32_t *n_triangles) __attribute__((warn_unused_result));

#endif
