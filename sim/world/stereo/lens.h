/* Table of the viewing direction of each pixel of a distorted camera. */
#ifndef SIM_WORLD_STEREO_LENS_H
#define SIM_WORLD_STEREO_LENS_H

#include <stddef.h>

#include "isotherm/camera.h"

struct sim_lens {
    struct iso_camera camera;
    float (*sight)[2]; /* [(height_px + 1) * (width_px + 1)]: x/z and y/z at the pixels' corners */
};

/* Computes the table of a camera. -ENOMEM. */
int sim_lens_new(const struct iso_camera *camera, struct sim_lens **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_lens_free(struct sim_lens *lens);

/* The direction (z = 1) of a point within pixel number i; a and b are 0..1 from its left to its
 * right and from its top to its bottom. It is interpolated between the pixel's corners, exact to
 * 1e-4 px. */
struct iso_vec3 sim_lens_sight(const struct sim_lens *lens, size_t i, double a, double b);

#endif
