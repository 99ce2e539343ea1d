/* A smooth random function of space, for hair and cloth. */
#ifndef SIM_BASE_NOISE3_H
#define SIM_BASE_NOISE3_H

#include <stdint.h>

#include "isotherm/vec.h"

/* Value noise (Perlin's lattice with smoothstep interpolation), -1..1. It varies over about one
 * unit of p. Another key gives an unrelated function. */
double sim_noise3(uint64_t key, struct iso_vec3 p);

#endif
