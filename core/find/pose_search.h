/* The face in a coarse frame: the best of many rough registrations.
 *
 * Every candidate is tried as the nose tip in nine attitudes (yaw and pitch), the mean face
 * registered by a few rigid steps; the best are refined, and from the best few of those the whole
 * head model is fitted. The nearest part of the scene in which it fits about as well as anywhere is
 * taken, so that a person standing behind the visitor is never meant. */
#ifndef ISO_CORE_FIND_POSE_SEARCH_H
#define ISO_CORE_FIND_POSE_SEARCH_H

#include "core/find/nose_candidate.h"
#include "core/landmark/shape_fit.h"

/* What a search works with and on. */
struct iso_pose_search {
    const struct iso_pose_vertices *vertices; /* a couple of hundred of the mean face */
    struct iso_shape_fitter *fitter;          /* set for few iterations */
    const struct iso_frame *frame;            /* in which the candidates were found */
    double cost_max_mm2;                      /* a worse fit is no face */
    double coverage_min;
};

/* Returns 0 and the pose, or -ENOENT if no part of the scene holds a face. Its cost includes what
 * the search adds for poor coverage and for being turned away. *several says whether there is
 * beyond doubt another face beside it, about as near. */
int iso_pose_search(const struct iso_pose_search *search,
                    const struct iso_nose_candidate *candidates, int n_candidates,
                    struct iso_pose_fit *out, bool *several) __attribute__((warn_unused_result));

#endif
