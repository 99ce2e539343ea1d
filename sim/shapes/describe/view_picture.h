/* The picture of the best views of a shape. */
#ifndef SIM_SHAPES_DESCRIBE_VIEW_PICTURE_H
#define SIM_SHAPES_DESCRIBE_VIEW_PICTURE_H

#include "isotherm/shape.h"
#include "sim/shapes/describe/array.h"

/* Draws the shape from each direction of the array `view`, with its scores below. Nothing is
 * written if there is no such array. -ENOMEM, -EIO; each with a fault. */
int sim_view_picture(const struct iso_shape *shape, const struct sim_arrays *arrays,
                     const char *path, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
