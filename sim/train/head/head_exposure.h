/* How much of a head's surface a sensor in front of it can see: not the insides of nostrils and
 * lips, which the head model has and no depth frame shows. */
#ifndef SIM_TRAIN_HEAD_HEAD_EXPOSURE_H
#define SIM_TRAIN_HEAD_HEAD_EXPOSURE_H

#include <stdbool.h>

#include "sim/train/head/head_surface.h"

/* For each vertex of the mean face the share, 0..1, of the directions about the front (yaw to 50
 * degrees, pitch to 40) from which it is seen, among those it faces: nothing lies more than 1 mm
 * before it. 0 for vertices that face none. -ENOMEM. */
int sim_head_exposure(const struct sim_head_surface *surface, double *exposure)
    __attribute__((warn_unused_result));

/* A vertex that is seen from fewer directions is inside a nostril or between the lips. */
static inline bool sim_head_is_exposed(double exposure)
{
    return exposure >= 0.8;
}

#endif
