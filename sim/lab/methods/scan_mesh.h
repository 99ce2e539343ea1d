/* A face as a triangle mesh, for methods that work with finite elements. */
#ifndef SIM_LAB_METHODS_SCAN_MESH_H
#define SIM_LAB_METHODS_SCAN_MESH_H

#include "isotherm/mesh.h"
#include "sim/lab/methods/scan.h"

struct sim_scan_mesh {
    struct iso_mesh *mesh;                           /* face frame, mm */
    int32_t (*adjacent)[3];                          /* [n_triangles], as iso_mesh_adjacency */
    int32_t *pixel;                                  /* [n_vertices]: of the scan's grid */
    struct iso_surface_point sources[ISO_LANDMARKS]; /* where the appliance releases heat */
};

/* Makes a mesh. Every `step`-th column and row, counted from the middle of the grid, becomes a
 * vertex (1: all of them). -EINVAL for a step outside 1..8; -ENODATA if there is no surface, or
 * none at a source (with a step of 1; a coarser mesh has no `sources`); -ENOMEM. */
int sim_scan_mesh_new(const struct sim_scan *face, int step, struct sim_scan_mesh **out)
    __attribute__((warn_unused_result));

/* Wipes and frees it and what it holds. NULL is accepted. */
void sim_scan_mesh_free(struct sim_scan_mesh *mesh);

#endif
