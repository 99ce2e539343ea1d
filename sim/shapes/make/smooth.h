/* The smoothing filter that section 4.2.4 of the dissertation puts before the descriptors. */
#ifndef SIM_SHAPES_MAKE_SMOOTH_H
#define SIM_SHAPES_MAKE_SMOOTH_H

#include "isotherm/mesh.h"

/* Taubin's filter (SIGGRAPH 1995): so many double steps of lambda 0.5 and mu -0.53 with umbrella
 * weights, which takes noise away and leaves limbs as thick as they are. Vertices of a boundary
 * follow the boundary only. -ENOMEM. */
int sim_smooth(struct iso_mesh *mesh, int steps) __attribute__((warn_unused_result));

#endif
