/* The face in a coarse frame: the best of many rough registrations.
 *
 * Every candidate is tried as the nose tip in nine attitudes (yaw and pitch); the mean face is
 * registered by a few rigid steps. The best ones are refined, and the whole head model is fitted
 * from the best few of those. The result is the fit to the nearest part of the scene whose cost is
 * near the lowest one, so that a person who stands behind the visitor is not taken. */
#ifndef ISO_CORE_FIND_POSE_SEARCH_H
#define ISO_CORE_FIND_POSE_SEARCH_H

#include "core/find/nose_candidate.h"
#include "core/landmark/shape_fit.h"

/* The tools of a search, and the frame that it searches. */
struct iso_pose_search {
    const struct iso_pose_vertices *vertices; /* about 200 vertices of the mean face */
    struct iso_shape_fitter *fitter;          /* with options for few iterations */
    const struct iso_frame *frame;            /* the frame of the candidates */
    double cost_max_mm2;                      /* a fit with a higher cost is no face */
    double coverage_min;                      /* a lower coverage makes the cost higher, 0..1 */
};

/* Returns 0 and the pose, or -ENOENT if no part of the scene holds a face. The cost of the pose
 * includes penalties for poor coverage and for being turned away. *several says whether there is
 * certainly another face beside it, at about the same distance. */
int iso_pose_search(const struct iso_pose_search *search,
                    const struct iso_nose_candidate *candidates, int n_candidates,
                    struct iso_pose_fit *out, bool *several) __attribute__((warn_unused_result));

#endif
