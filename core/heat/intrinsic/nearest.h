/* The nearest neighbours of points in space, by a k-d tree (Bentley, "Multidimensional binary
 * search trees used for associative searching", Communications of the ACM 18(9), 1975). */
#ifndef ISO_CORE_HEAT_INTRINSIC_NEAREST_H
#define ISO_CORE_HEAT_INTRINSIC_NEAREST_H

#include <stdint.h>

#include "isotherm/vec.h"

/* The tree has no nodes: the middle of each stretch of `order` divides the others, along the axis
 * in which the stretch is longest. */
struct iso_nearest {
    const struct iso_vec3 *point; /* borrowed */
    int32_t n;
    int32_t *order; /* [n]: numbers of points */
    uint8_t *axis;  /* [n]: of the point at this place of the order */
};

/* A neighbour and the square of its distance. */
struct iso_neighbour {
    double square;
    int32_t point;
};

/* Makes the tree of the points number [n], which are different. -ENOMEM. */
int iso_nearest_init(struct iso_nearest *tree, const struct iso_vec3 *point, const int32_t *number,
                     int32_t n) __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_nearest_done(struct iso_nearest *tree);

/* Finds the k points of the tree that are nearest to one of its points. The point itself is not
 * among them. out [k] has them by rising distance, and points of equal distance by rising number.
 * Returns how many it found: fewer than k only if the tree has fewer other points. */
int iso_nearest_find(const struct iso_nearest *tree, int32_t point, int k,
                     struct iso_neighbour *out);

#endif
