/* Whether a camera distorts; and the points of a frame, without a call if its camera does not. */
#ifndef ISO_CORE_FRAME_DISTORTION_H
#define ISO_CORE_FRAME_DISTORTION_H

#include "isotherm/frame.h"

static inline bool iso_camera_is_distorted(const struct iso_camera *c)
{
    return c->k1 != 0.0 || c->k2 != 0.0 || c->k3 != 0.0 || c->p1 != 0.0 || c->p2 != 0.0;
}

/* As iso_frame_point_at(). */
static inline struct iso_vec3 iso_frame_point_quick(const struct iso_frame *frame, int column,
                                                    int row)
{
    const struct iso_camera *c = &frame->camera;
    if (c->projection != ISO_PINHOLE || iso_camera_is_distorted(c)) {
        return iso_frame_point_at(frame, column, row);
    }
    const double z = (double)iso_frame_depth_at(frame, column, row);
    const double x = (column + frame->crop_x_px - c->cx_px) / c->fx_px;
    const double y = (row + frame->crop_y_px - c->cy_px) / c->fy_px;
    return iso_vec3(x * z, y * z, z);
}

#endif
