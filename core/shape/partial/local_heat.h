/* Local heat: a shape as points of its surface, each with the heat that is still there at some
 * short times, for shapes of which a part may be missing.
 *
 * K(x, x, t), the heat kernel signature (Sun, Ovsjanikov and Guibas 2009), does not know of
 * anything that lies much farther from x than 2 sqrt(t): heat that has been there and back is less
 * by exp(-d^2 / t), d being the distance (Varadhan 1967). Therefore a cut changes the signature
 * only near the cut. It also changes the area, in which times are measured. So the signature
 * is kept at so many times that a part can be compared with a whole whose area was a given number
 * of times as large: another scale is only a shift of the logarithm of time, and a constant.
 *
 * The parts of a description, and of its feature:
 *
 *   - [0], COARSE values: the share of the area that is nearest to each of the first points; 0 for
 *     a point that the shape does not have;
 *   - [1], COARSE values: the squares of their distances from the boundary, in areas, at most FAR;
 *   - [2], POINTS x TIMES values: log(A K(x, x, t)) at t = A 2^(FIRST + j STEP), A being the area.
 *
 * The first points of a query look for their like among all points of another shape: these have to
 * be dense, so that each place has one like it, while the former have to be only a fair sample. A
 * shape of fewer vertices has its first point several times among all points. */
#ifndef ISO_CORE_SHAPE_PARTIAL_LOCAL_HEAT_H
#define ISO_CORE_SHAPE_PARTIAL_LOCAL_HEAT_H

#include <stdbool.h>

#include "isotherm/shape_method.h"

enum {
    ISO_LOCAL_COARSE = 200,
    ISO_LOCAL_POINTS = 400,
    ISO_LOCAL_TIMES = 30,
    ISO_LOCAL_PARTS = 3,
};

/* The logarithms, to base 2, of the first time in areas and of the ratio of times. */
#define ISO_LOCAL_FIRST (-8.2)
#define ISO_LOCAL_STEP  0.2

/* What stands for the square of a distance from a boundary that does not exist. */
#define ISO_LOCAL_FAR 1e3

/* Whether features of this layout are those of local heat. */
bool iso_is_local_heat(const struct iso_feature_layout *layout);

#endif
