/* Ambient occlusion: the share of the sky that the surrounding surface hides from a place. Internal
 * to sim/lab/picture.
 *
 * It is computed from the horizon in several directions up to a reach of 28 mm (horizon-based:
 * Bavoil, Sainz and Dimitrov 2008), on one sample for each pixel, and then smoothed. */
#ifndef SIM_LAB_PICTURE_OCCLUSION_H
#define SIM_LAB_PICTURE_OCCLUSION_H

#include "sim/lab/picture/scene_data.h"

struct sim_occlusion {
    int width, height; /* in pixels of the picture */
    float *open;       /* [height * width]: 1 where nothing is hidden */
};

/* Computes the occlusion of a scene. Free `open` with free(). -ENOMEM. */
int sim_occlusion_compute(const struct sim_scene *scene, struct sim_occlusion *out)
    __attribute__((warn_unused_result));

#endif
