/* Makes a closed triangle mesh of a level set of a field, by marching tetrahedra (Doi and Koide
 * 1991). Each cube of a grid is cut into the six tetrahedra around its diagonal. They fill space
 * face to face, so that the surface never has holes or edges of three triangles. */
#ifndef SIM_SHAPES_MAKE_POLYGONISE_H
#define SIM_SHAPES_MAKE_POLYGONISE_H

#include <stddef.h>

#include "isotherm/mesh.h"

/* Samples of a field on a grid of nx x ny x nz nodes; node (i, j, k) is at
 * origin + pitch (i, j, k), its value at (k ny + j) nx + i. */
struct sim_field_grid {
    int nx, ny, nz;
    struct iso_vec3 origin_mm;
    double pitch_mm;
    double *value;
};

/* The surface where the field equals `level`, counter-clockwise seen from the side with the
 * lower field. It is closed if the field is below the level on the border of the grid. A vertex
 * keeps a distance of a tenth of its edge from both ends, so that no triangle shrinks to
 * nothing. -EINVAL for less than 2 nodes on a side or no surface, -ENOMEM. */
int sim_polygonise(const struct sim_field_grid *grid, double level, struct iso_mesh **out)
    __attribute__((warn_unused_result));

#endif
