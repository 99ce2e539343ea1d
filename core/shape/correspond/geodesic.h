/* Geodesic distances in heat (Crane, Weischedel and Wardetzky, "Geodesics in heat", ACM TOG 32,
 * 2013): heat flows from a vertex for a short time t, the square of the mean length of the edges;
 * its gradient, made a field of unit vectors, points away from the vertex; the distance is the
 * function whose gradient is nearest to that field. Two solves for each source. */
#ifndef ISO_CORE_SHAPE_CORRESPOND_GEODESIC_H
#define ISO_CORE_SHAPE_CORRESPOND_GEODESIC_H

#include "isotherm/shape.h"

struct iso_geodesic;

/* Factorises what all sources share. The shape is borrowed. Only one thread at a time may use it.
 * -EDOM if a matrix cannot be factorised, -ENOMEM. */
int iso_geodesic_new(const struct iso_shape *shape, struct iso_geodesic **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_geodesic_free(struct iso_geodesic *geodesic);

/* Distances [n_vertices] of all vertices from one, in the unit of the mesh. -EINVAL for a vertex
 * out of range, -ENOMEM. */
int iso_geodesic_distance(struct iso_geodesic *geodesic, int32_t vertex, double *distance)
    __attribute__((warn_unused_result));

#endif
