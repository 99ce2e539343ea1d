/* Pictures of functions on a shape. */
#ifndef SIM_SHAPES_DESCRIBE_FUNCTION_PICTURE_H
#define SIM_SHAPES_DESCRIBE_FUNCTION_PICTURE_H

#include "isotherm/shape.h"
#include "sim/shapes/describe/array.h"

/* Draws every array that has a row for each vertex, other than the vertices themselves: a row of
 * pictures of up to four columns of the array, with its name and the least and the greatest value
 * below. The colours run from the 1st to the 99th percentile: from cold to hot, or from blue over
 * white (0) to red for a function with both signs. The array `critical`, if there is one, is drawn
 * as dots. Nothing is written if there is no such array. -ENOMEM, -EIO; each with a fault. */
int sim_function_picture(const struct iso_shape *shape, const struct sim_arrays *arrays,
                         const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
