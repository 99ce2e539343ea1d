/* The face in a coarse frame: the best of many rough registrations of the mean face.
 *
 * Every candidate is tried as the nose tip in nine attitudes (yaw and pitch), each registered by
 * a few rigid steps; the best few are refined. The nearest part of the scene in which the mean face
 * fits is taken, so that a person standing behind the visitor is never meant. */
#ifndef ISO_CORE_FIND_POSE_SEARCH_H
#define ISO_CORE_FIND_POSE_SEARCH_H

#include "core/find/candidate.h"
#include "core/landmark/pose_fit.h"

struct iso_pose_search_options {
    double cost_max_mm2; /* a worse fit is no face */
    double coverage_min;
};

/* Registers to the frame in which the candidates were found. Returns 0 and the pose, or -ENOENT if
 * no part of the scene holds a face. */
int iso_pose_search(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                    const struct iso_candidate *candidates, int n_candidates,
                    const struct iso_pose_search_options *options, struct iso_pose_fit *out)
    __attribute__((warn_unused_result));

#endif
