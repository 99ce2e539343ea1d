/* The rigid transform that best takes one set of points to another, in closed form. */
#ifndef ISO_CORE_MATCH_RIGID_H
#define ISO_CORE_MATCH_RIGID_H

#include "core/math/vec.h"

/* Minimises sum_i weight[i] |T source[i] - target[i]|^2 over proper rigid motions T (Horn 1987,
 * unit quaternions: the eigenvector of the largest eigenvalue of a symmetric 4x4 matrix, by Jacobi
 * rotations). weight may be NULL (all 1); weights are >= 0. -EINVAL unless at least 3 points have a
 * positive weight. Collinear points leave a rotation about their line undetermined: one is chosen.
 */
int iso_rigid_fit(const struct iso_vec3 *source, const struct iso_vec3 *target,
                  const double *weight, int n, struct iso_rigid *target_from_source)
    __attribute__((warn_unused_result));

#endif
