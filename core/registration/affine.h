/* The affine transform that best takes one set of points to another, in closed form. */
#ifndef ISO_CORE_REGISTRATION_AFFINE_H
#define ISO_CORE_REGISTRATION_AFFINE_H

#include "isotherm/vec.h"

/* x -> m[.][0..2] x + m[.][3] */
struct iso_affine {
    double m[3][4];
};

/* The transform that moves nothing. */
struct iso_affine iso_affine_identity(void);

/* The same motion as an affine transform. */
struct iso_affine iso_affine_of_rigid(const struct iso_rigid *rigid);

/* The transform of a point. */
static inline struct iso_vec3 iso_affine_apply(const struct iso_affine *a, struct iso_vec3 v)
{
    return iso_vec3(a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z + a->m[0][3],
                    a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z + a->m[1][3],
                    a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z + a->m[2][3]);
}

/* Minimises sum_i weight[i] |A source[i] - target[i]|^2 over all affine A: the 12x12 system of
 * Abdelrahman 2013, appendix F (F-6 to F-9), which falls into three 4x4 systems with one matrix
 * (Cholesky). The 9th entry of the text's F-7 should read x_1 y_3. weight may be NULL (all 1).
 * -EINVAL with fewer than 4 points of positive weight, -EDOM if the points lie in a plane. */
int iso_affine_fit(const struct iso_vec3 *source, const struct iso_vec3 *target,
                   const double *weight, int n, struct iso_affine *target_from_source)
    __attribute__((warn_unused_result));

#endif
