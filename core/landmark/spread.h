/* An order of the face's vertices in which the first few are spread evenly. Internal to
 * core/landmark. */
#ifndef ISO_CORE_LANDMARK_SPREAD_H
#define ISO_CORE_LANDMARK_SPREAD_H

#include "isotherm/head_model.h"

/* Writes at most `most` vertices of the region ISO_HEAD_FACE, by farthest-point sampling of the
 * mean face (Gonzalez 1985): every first few of them are spread evenly over it. `order` has room
 * for all vertices of the model. -ENOMEM. */
int iso_head_spread(const struct iso_head_model *model, int most, uint32_t *order, int *n)
    __attribute__((warn_unused_result));

#endif
