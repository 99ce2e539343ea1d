/* Points spread evenly over a shape, and how far they are from its boundary. Distances are lengths
 * of ways along the edges (Dijkstra 1959), which are some percent longer than geodesics. */
#ifndef ISO_CORE_SHAPE_PARTIAL_SURFACE_POINTS_H
#define ISO_CORE_SHAPE_PARTIAL_SURFACE_POINTS_H

#include "isotherm/shape.h"

/* Chooses `n` points: `first`, then each time the vertex that is farthest from all points before
 * (Gonzalez 1985). vertex[n] are the points, weight[n] the shares of the area that is nearest to
 * each, sum 1. A shape of fewer vertices has fewer points: the others are `first` again, with
 * weight 0. -ENOMEM. */
int iso_surface_points(const struct iso_shape *shape, int32_t first, int32_t n, int32_t *vertex,
                       double *weight) __attribute__((warn_unused_result));

/* Sets distance[n_vertices] to the distance of each vertex from the vertices on the boundary or two
 * edges or less from it; INFINITY for all vertices of a closed surface. -ENOMEM. */
int iso_boundary_distance(const struct iso_shape *shape, double *distance)
    __attribute__((warn_unused_result));

#endif
