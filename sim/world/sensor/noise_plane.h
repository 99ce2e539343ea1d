/* Planes of correlated Gaussian noise. */
#ifndef SIM_WORLD_SENSOR_NOISE_PLANE_H
#define SIM_WORLD_SENSOR_NOISE_PLANE_H

#include "sim/base/random.h"

/* Fills out[height][width] with normal deviates of standard deviation 1 that are averages over
 * windows of (2 radius_u + 1) x (2 radius_v + 1) independent ones, wrapped around at the borders:
 * what errors of a sensor look like that compares such windows. Radii >= 0 and below half the size.
 * `scratch` is another plane. */
void sim_noise_plane(struct sim_random *random, int width, int height, int radius_u, int radius_v,
                     float *scratch, float *out);

#endif
