/* The rigid transform that best takes one set of points to another, in closed form. */
#ifndef ISO_CORE_REGISTRATION_RIGID_H
#define ISO_CORE_REGISTRATION_RIGID_H

#include "isotherm/vec.h"

/* Minimises sum_i weight[i] |T source[i] - target[i]|^2 over proper rigid motions T (Horn 1987,
 * unit quaternions: the eigenvector of the largest eigenvalue of a symmetric 4x4 matrix, by Jacobi
 * rotations). The arrays are [n]. Weights are >= 0; NULL means that all weights are 1. -EINVAL
 * unless at least 3 points have a positive weight. Collinear points do not determine the rotation
 * about their line: any rotation about it may be the result. */
int iso_rigid_fit(const struct iso_vec3 *source, const struct iso_vec3 *target,
                  const double *weight, int n, struct iso_rigid *target_from_source)
    __attribute__((warn_unused_result));

/* The same fit in steps, for callers that have no arrays of the points. The sums are all zero at
 * first. Give every point to iso_rigid_sums_first, call iso_rigid_sums_centre, give every point to
 * iso_rigid_sums_second, and call iso_rigid_sums_fit. */
struct iso_rigid_sums {
    int used; /* points of positive weight */
    double weight;
    struct iso_vec3 source_mean, target_mean; /* sums, before iso_rigid_sums_centre() */
    double s[3][3];                           /* sum w source_i target_j, about the means */
};

/* Adds a pair of points to the means. w >= 0 is its weight. */
static inline void iso_rigid_sums_first(struct iso_rigid_sums *sums, struct iso_vec3 source,
                                        struct iso_vec3 target, double w)
{
    sums->used += w > 0.0;
    sums->weight += w;
    sums->source_mean = iso_madd(sums->source_mean, w, source);
    sums->target_mean = iso_madd(sums->target_mean, w, target);
}

/* Makes means of the sums. -EINVAL as for iso_rigid_fit(). */
int iso_rigid_sums_centre(struct iso_rigid_sums *sums) __attribute__((warn_unused_result));

/* Adds a pair of points to the products, with the same weight as in the first round. */
static inline void iso_rigid_sums_second(struct iso_rigid_sums *sums, struct iso_vec3 source,
                                         struct iso_vec3 target, double w)
{
    const struct iso_vec3 a = iso_scale(w, iso_sub(source, sums->source_mean));
    const struct iso_vec3 b = iso_sub(target, sums->target_mean);
    const double av[3] = {a.x, a.y, a.z}, bv[3] = {b.x, b.y, b.z};
    for (int j = 0; j < 3; j++) {
        for (int k = 0; k < 3; k++) {
            sums->s[j][k] += av[j] * bv[k];
        }
    }
}

/* The motion that takes the source points closest to the target points. */
struct iso_rigid iso_rigid_sums_fit(const struct iso_rigid_sums *sums);

#endif
