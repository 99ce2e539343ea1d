/* Fewer vertices for meshes that have more than a study needs. */
#ifndef SIM_SHAPES_MAKE_THIN_H
#define SIM_SHAPES_MAKE_THIN_H

#include "sim/shapes/mesh/mesh_file.h"

/* Collapses edges (sim/train/head/decimate.h) until n_vertices are left, or as few as that allows,
 * and leaves out what became unused; colours stay with their vertices. A mesh with a vertex of more
 * triangles than that can deal with stays as it is. -ENOMEM. */
int sim_thin(struct iso_coloured_mesh *mesh, int32_t n_vertices)
    __attribute__((warn_unused_result));

#endif
