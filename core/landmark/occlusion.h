/* Which parts of a fitted face are covered: by a hand, hair, a scarf, or a hole in the frame. */
#ifndef ISO_CORE_LANDMARK_OCCLUSION_H
#define ISO_CORE_LANDMARK_OCCLUSION_H

#include "core/landmark/shape_fit.h"

/* Sets parts[i] to the parts to which vertex i of the model belongs, as bits 1 << enum
 * iso_face_part, from its place in the mean face; 0 for a vertex outside the face. `parts` has room
 * for all vertices. */
void iso_face_parts_of(const struct iso_head_model *model, uint8_t *parts);

/* Measures which parts of a fitted head are covered. `parts` comes from iso_face_parts_of. */
struct iso_occlusion iso_occlusion_measure(const struct iso_shape_residuals *head,
                                           const uint8_t *parts);

#endif
