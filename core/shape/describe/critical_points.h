/* Critical points: the vertices where the first non-trivial eigenfunction has an extremum over its
 * two rings of neighbours, except near a boundary. Abdelrahman 2013, section 4.1 (after Reuter
 * 2010). They lie at the tips of a shape: there are as many as limbs, whatever the pose. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_CRITICAL_POINTS_H
#define ISO_CORE_SHAPE_DESCRIBE_CRITICAL_POINTS_H

#include "isotherm/shape.h"

struct iso_critical_points {
    int32_t n;
    int32_t *vertex; /* [n], by falling |value| of the eigenfunction */
};

/* Finds the extrema of any function of the vertices. Of two equal values, that of the vertex with
 * the larger index counts as higher. n is 0 if there is no extremum away from the boundary.
 * -ENOMEM. */
int iso_shape_extrema(const struct iso_shape *shape, const double *function,
                      struct iso_critical_points *out) __attribute__((warn_unused_result));

/* The extrema of the first non-trivial eigenfunction. There is at least one: if all extrema lie
 * near the boundary, it is the vertex of the largest |value|. -ENOMEM. */
int iso_shape_critical_points(const struct iso_shape *shape, struct iso_critical_points *out)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_critical_points_done(struct iso_critical_points *points);

#endif
