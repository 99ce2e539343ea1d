/* Reduces the number of vertices of meshes that are finer than a study needs. */
#ifndef SIM_SHAPES_MAKE_THIN_H
#define SIM_SHAPES_MAKE_THIN_H

#include "sim/shapes/mesh/mesh_file.h"

/* Collapses edges (sim/train/head/decimate.h) until n_vertices are left, or as few as the
 * collapse allows, and removes unused vertices. Colours stay with their vertices. -EINVAL for a
 * vertex of more than SIM_DECIMATE_FAN_LIMIT triangles, -ENOMEM; the mesh is then unchanged. */
int sim_thin(struct iso_coloured_mesh *mesh, int32_t n_vertices)
    __attribute__((warn_unused_result));

#endif
