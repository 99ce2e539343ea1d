/* Places where the tip of a nose may be: convex places of the right size in a coarse frame.
 *
 * The frame is shrunk to about 4 mm a pixel. The score of a place is its height above the plane
 * through a ring of 40 mm about it (nose tips: 15..35 mm, at any pose up to 40 degrees). The
 * surface is first split into parts at depth jumps. Candidates come part by part, the nearest part
 * first, because the nearest of several people is the visitor. */
#ifndef ISO_CORE_FIND_NOSE_CANDIDATE_H
#define ISO_CORE_FIND_NOSE_CANDIDATE_H

#include "isotherm/frame.h"

enum {
    ISO_CANDIDATES_MAX = 32,
    ISO_CANDIDATES_PER_PART = 12,
    ISO_CANDIDATE_PARTS_MAX = 4,
};

struct iso_nose_candidate {
    struct iso_vec3 point_mm; /* camera frame */
    double height_mm;         /* above the ring's plane */
    double stands_out_mm;     /* of a wide ring (ring_height.h) */
    int part;                 /* 0: the nearest part of the scene */
};

struct iso_candidate_options {
    double near_mm, far_mm; /* depths looked at */
};

/* Working memory of a search. */
struct iso_candidate_finder;

/* Makes a finder for frames of up to capacity_px pixels. -ENOMEM. */
int iso_candidate_finder_new(size_t capacity_px, struct iso_candidate_finder **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_candidate_finder_free(struct iso_candidate_finder *finder);

/* Writes at most ISO_CANDIDATES_MAX candidates, part by part, and within a part by falling height.
 * *n_candidates is their number. *n_parts is the number of parts in range that are large enough for
 * a face, at most ISO_CANDIDATE_PARTS_MAX. Both may be 0. -ENOSPC over the finder's capacity. */
int iso_candidates_find(struct iso_candidate_finder *finder, const struct iso_frame *frame,
                        const struct iso_candidate_options *options,
                        struct iso_nose_candidate candidates[ISO_CANDIDATES_MAX], int *n_candidates,
                        int *n_parts) __attribute__((warn_unused_result));

#endif
