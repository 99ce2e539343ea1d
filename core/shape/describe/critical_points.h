/* Critical points: the vertices where the first non-trivial eigenfunction has an extremum over its
 * two rings of neighbours, none near a boundary. Abdelrahman 2013, section 4.1 (after Reuter 2010).
 * They are the tips of a shape: their number is that of its limbs, whatever its pose. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_CRITICAL_POINTS_H
#define ISO_CORE_SHAPE_DESCRIBE_CRITICAL_POINTS_H

#include "isotherm/shape.h"

struct iso_critical_points {
    int32_t n;
    int32_t *vertex; /* [n], by falling |value| of the eigenfunction */
};

/* Extrema of any function of the vertices. Of equal values at neighbours the lowest index counts. A
 * function without extremum (every one near the boundary) has n = 0. -ENOMEM. */
int iso_shape_extrema(const struct iso_shape *shape, const double *function,
                      struct iso_critical_points *out) __attribute__((warn_unused_result));

/* Those of the first non-trivial eigenfunction; at least one: where all extrema lie near the
 * boundary, the one vertex of the largest |value|. -ENOMEM. */
int iso_shape_critical_points(const struct iso_shape *shape, struct iso_critical_points *out)
    __attribute__((warn_unused_result));

void iso_critical_points_done(struct iso_critical_points *points);

#endif
