/* Trimmed iterative closest point between two families of curves. */
#ifndef ISO_CORE_REGISTRATION_ICP_H
#define ISO_CORE_REGISTRATION_ICP_H

#include <stdbool.h>

#include "core/registration/affine.h"

enum { ISO_ICP_POINTS_MAX = 2048 };

/* Points in groups of equal size; a point is matched only within the group of the same number
 * (the isotherm of the same landmark and radius). Weight 0: missing. */
struct iso_icp_points {
    int n_groups, n_per_group; /* n_groups * n_per_group <= ISO_ICP_POINTS_MAX */
    const float (*point_mm)[3];
    const float *weight;
};

enum iso_icp_transform {
    ISO_ICP_RIGID = 0,
    ISO_ICP_AFFINE, /* as printed in Abdelrahman 2013, appendix F */
};

enum iso_icp_pairing {
    ISO_ICP_NEAREST = 0, /* the nearest point of the group */
    ISO_ICP_ORDERED,     /* the point of the same number: polar sampling makes them correspond */
};

struct iso_icp_options {
    enum iso_icp_transform transform;
    enum iso_icp_pairing pairing;
    double trim;               /* share of the pairs that count, the closest ones, in (0, 1] */
    int iterations_max;        /* >= 1 */
    double tolerance_mm;       /* stop when the trimmed distance changes by less than this */
    const float *group_weight; /* [n_groups] factor on the weights of a group; NULL: 1; 0: as if the
                                * group's points were missing */
};

struct iso_icp_result {
    struct iso_affine target_from_source;
    double distance_mm;    /* weighted mean distance of the pairs that count */
    int pairs, iterations; /* pairs of the last iteration; iterations done */
    bool converged;        /* the tolerance was reached */
};

/* Working memory of a registration, 164 kB. It is allocated once and used by one thread at a time;
 * it needs no initial values. All arrays have an entry for each pair of one iteration. It holds
 * biometric data after use: its owner wipes it. */
struct iso_icp_workspace {
    int n;
    struct iso_vec3 source[ISO_ICP_POINTS_MAX], target[ISO_ICP_POINTS_MAX];
    double weight[ISO_ICP_POINTS_MAX];   /* product of the weights of both points and the group */
    double distance[ISO_ICP_POINTS_MAX]; /* after the present transform, mm */
    double trimmed[ISO_ICP_POINTS_MAX];  /* the weight, or 0 for a pair that does not count */
    double sorted[ISO_ICP_POINTS_MAX];   /* the distances, reordered to find the limit */
};

/* Registers the source to the target by trimmed ICP (Besl and McKay 1992; Chetverikov, Svirko,
 * Stepanov and Krsek 2002). Each iteration makes pairs, keeps the closest `trim` share of them, and
 * computes the transform of these in closed form. It starts from the identity, and the first
 * pairing is always ordered. -EINVAL for sizes that differ or options out of range, -ENODATA with
 * fewer than 12 pairs, -EDOM if an affine system is singular. */
int iso_icp(struct iso_icp_workspace *work, const struct iso_icp_points *source,
            const struct iso_icp_points *target, const struct iso_icp_options *options,
            struct iso_icp_result *result) __attribute__((warn_unused_result));

#endif
