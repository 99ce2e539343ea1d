/* Which parts of a fitted face are covered: by a hand, hair, a scarf, or a hole in the frame. */
#ifndef ISO_CORE_LANDMARK_OCCLUSION_H
#define ISO_CORE_LANDMARK_OCCLUSION_H

#include "core/landmark/shape_fit.h"

enum iso_face_part {
    ISO_PART_BROW,
    ISO_PART_EYES,
    ISO_PART_NOSE,
    ISO_PART_MOUTH,
    ISO_PART_LEFT, /* the subject's left side, without nose and mouth */
    ISO_PART_RIGHT,
    ISO_FACE_PARTS
};

/* "brow", "eyes", ...; NULL outside the range. */
const char *iso_face_part_name(enum iso_face_part part);

struct iso_occlusion {
    /* Of the part's vertices that the camera should see, the share that it does not: something lies
     * more than 10 mm before them, or nothing was measured. 0 for a part that is turned away. */
    double covered[ISO_FACE_PARTS];
    double rest_mm2; /* how well the rest fits: mean of min(r^2, 36) of what is measured and bare */
};

/* The parts that each vertex of the model's face belongs to, as bits 1 << enum iso_face_part, by
 * its place in the mean face; `parts` has room for all vertices. */
void iso_face_parts_of(const struct iso_head_model *model, uint8_t *parts);

struct iso_occlusion iso_occlusion_measure(const struct iso_shape_residuals *head,
                                           const uint8_t *parts);

#endif
