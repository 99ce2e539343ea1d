/* The smoothing filter that section 4.2.4 of the dissertation applies before the descriptors. */
#ifndef SIM_SHAPES_MAKE_SMOOTH_H
#define SIM_SHAPES_MAKE_SMOOTH_H

#include "isotherm/mesh.h"

/* Taubin's filter (SIGGRAPH 1995): the given number of double steps of lambda 0.5 and mu -0.53
 * with umbrella weights. It removes noise and keeps the thickness of limbs. Vertices of a
 * boundary follow only the boundary. -ENOMEM. */
int sim_smooth(struct iso_mesh *mesh, int steps) __attribute__((warn_unused_result));

#endif
