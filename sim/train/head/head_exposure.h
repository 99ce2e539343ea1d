/* How much of a head's surface a sensor in front of it can see. The head model contains the
 * insides of nostrils and lips, which no depth frame shows. */
#ifndef SIM_TRAIN_HEAD_HEAD_EXPOSURE_H
#define SIM_TRAIN_HEAD_HEAD_EXPOSURE_H

#include <stdbool.h>

#include "sim/train/head/head_surface.h"

/* Looks at the mean face from directions around the front (yaw to 50 degrees, pitch to 40).
 * exposure[v] is the share, 0..1, of the directions that vertex v faces from which it is visible.
 * Visible means that no surface lies more than 1 mm before it. The share is 0 for vertices that
 * face none of the directions. -ENOMEM. */
int sim_head_exposure(const struct sim_head_surface *surface, double *exposure)
    __attribute__((warn_unused_result));

/* Whether a vertex of this exposure is on the outside. With a smaller share it is inside a nostril
 * or between the lips. */
static inline bool sim_head_is_exposed(double exposure)
{
    return exposure >= 0.8;
}

#endif
