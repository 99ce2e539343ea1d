/* Distances between features, by the norm of a method. */
#ifndef ISO_CORE_SHAPE_CLASSIFY_FEATURE_DISTANCE_H
#define ISO_CORE_SHAPE_CLASSIFY_FEATURE_DISTANCE_H

#include "isotherm/shape_method.h"

/* Sets distance[i] to the distance of `feature` from item[i], for each of n items of the layout;
 * that of the item number `left` (-1: none) is 0. -EINVAL for ISO_NORM_PARTIAL with features that
 * are not of local heat, -ENOMEM. */
int iso_feature_distances(const struct iso_feature_layout *layout, enum iso_norm norm,
                          const float *feature, const float *item, int32_t n, int32_t left,
                          double *distance) __attribute__((warn_unused_result));

#endif
