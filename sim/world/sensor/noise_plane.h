/* Planes of correlated Gaussian noise. */
#ifndef SIM_WORLD_SENSOR_NOISE_PLANE_H
#define SIM_WORLD_SENSOR_NOISE_PLANE_H

#include "sim/base/random.h"

/* Fills out[height][width] with correlated normal deviates of standard deviation 1. Each is the
 * scaled sum over a window of (2 radius_u + 1) x (2 radius_v + 1) independent deviates, wrapped
 * around at the borders. A sensor that compares such windows has errors of this kind. Radii are
 * >= 0 and below half the size. `scratch` is another plane. */
void sim_noise_plane(struct sim_random *random, int width, int height, int radius_u, int radius_v,
                     float *scratch, float *out);

#endif
