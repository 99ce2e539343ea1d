/* The outline of the mean head in the pose of a face. It is the same for everybody in the same
 * pose, so it shows where a face is and nothing that tells one face from another. Pure. */
#ifndef ISO_FIRMWARE_STREAM_HEAD_OUTLINE_H
#define ISO_FIRMWARE_STREAM_HEAD_OUTLINE_H

#include "firmware/contract/stream_record.h"
#include "isotherm/frame.h"
#include "isotherm/head_model.h"
#include "isotherm/vec.h"

enum { ISO_HEAD_OUTLINE_POINTS = 256 };

/* The points of the mean head that can lie on its outline: those that lie farthest in one of 256
 * directions. */
struct iso_head_outline {
    int n;
    struct iso_vec3 point_mm[ISO_HEAD_OUTLINE_POINTS]; /* face frame */
};

/* Selects the points. A model without vertices gives none. */
void iso_head_outline_init(struct iso_head_outline *outline, const struct iso_head_model *model);

/* Where a pixel of the frame lies in the silhouette. The frame fills the silhouette as far as its
 * proportions allow, and lies in the middle. */
struct iso_silhouette_scale {
    double px;        /* pixels of the frame in one silhouette point */
    double left, top; /* the corner of the frame, in silhouette points */
};
struct iso_silhouette_scale iso_silhouette_scale_of(const struct iso_frame *frame);

/* Projects the head into the silhouette of the frame and takes the convex hull (Andrew 1979).
 * `xy` receives the points of the hull as stream_record.h describes them, clockwise. Returns their
 * number, 3..ISO_OUTLINE_POINTS, or 0 if a point lies behind the camera or there is no area. */
int iso_head_outline_project(const struct iso_head_outline *outline,
                             const struct iso_rigid *camera_from_face,
                             const struct iso_frame *frame, int16_t xy[ISO_OUTLINE_POINTS][2]);

#endif
