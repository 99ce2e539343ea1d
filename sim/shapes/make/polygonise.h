/* A closed triangle mesh of a level of a field, by marching tetrahedra (Doi and Koide 1991): each
 * cube of a grid is cut into the six tetrahedra about its diagonal, which tile space face to face,
 * so that the surface has neither holes nor edges of three triangles whatever the field is. */
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

/* The surface where the field is `level`, counter-clockwise seen from where it is lower. It is
 * closed if the field is below the level on the border of the grid. A vertex keeps a tenth of its
 * edge away from either end, so that triangles do not shrink to nothing. -EINVAL for less than 2
 * nodes a side or no surface, -ENOMEM. */
int sim_polygonise(const struct sim_field_grid *grid, double level, struct iso_mesh **out)
    __attribute__((warn_unused_result));

#endif
