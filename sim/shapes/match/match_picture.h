/* The picture of a map of points. */
#ifndef SIM_SHAPES_MATCH_MATCH_PICTURE_H
#define SIM_SHAPES_MATCH_MATCH_PICTURE_H

#include "core/base/fault.h"
#include "isotherm/shape.h"

/* Draws two shapes beside each other: `from` in colours of its places, `to` with each vertex in the
 * colour of its point. -ENOMEM, -EIO; each with a fault. */
int sim_match_picture(const struct iso_shape *from, const struct iso_shape *to,
                      const int32_t *point, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
