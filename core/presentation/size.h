/* How large a face is beside the people that the head model was trained on.
 *
 * A fitted head follows a face that is too small or too large as far as its modes go, and hides it.
 * So the mean face, which has none, is registered with a free scale: point to plane with projective
 * association as in pose_fit.h, over seven unknowns (similarity instead of rigid motion; Umeyama
 * 1991 for the group). The scale of people is then spread about 1 by what their identity adds. */
#ifndef ISO_CORE_PRESENTATION_SIZE_H
#define ISO_CORE_PRESENTATION_SIZE_H

#include "core/landmark/pose_fit.h"

struct iso_size {
    double scale;    /* of the measured face over the mean face */
    double cost_mm2; /* mean of min(r^2, 36) there, as of iso_pose_fit */
    double coverage; /* share of the facing vertices that were measured */
};

/* `vertices` of the mean face; `camera_from_face` where the head model was fitted in this frame.
 * -ENODATA if too little is measured to fix the scale. */
int iso_size_measure(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                     const struct iso_rigid *camera_from_face, struct iso_size *out)
    __attribute__((warn_unused_result));

#endif
