#include "isotherm/frame.h"

#include <errno.h>
#include <stdlib.h>

#include "core/base/fault.h"
#include "core/frame/depth_lanes.h"

enum { SIDE_MAX = 8192 };

static const float depth_end_mm = 1e6f; /* depths are less than this */

static bool size_sane(int width_px, int height_px)
{
    return width_px >= 1 && width_px <= SIDE_MAX && height_px >= 1 && height_px <= SIDE_MAX;
}

int iso_frame_new(const struct iso_camera *camera, int width_px, int height_px, bool with_intensity,
                  struct iso_frame **out)
{
    if (!size_sane(width_px, height_px)) {
        return -EINVAL;
    }
    struct iso_frame *f = calloc(1, sizeof *f);
    if (!f) {
        return -ENOMEM;
    }
    const size_t n = (size_t)width_px * (size_t)height_px;
    f->camera = *camera;
    f->width_px = width_px;
    f->height_px = height_px;
    f->depth_mm = calloc(n, sizeof *f->depth_mm);
    f->intensity = with_intensity ? calloc(n, sizeof *f->intensity) : NULL;
    if (!f->depth_mm || (with_intensity && !f->intensity)) {
        iso_frame_free(f);
        return -ENOMEM;
    }
    *out = f;
    return 0;
}

void iso_frame_free(struct iso_frame *frame)
{
    if (frame) {
        free(frame->depth_mm);
        free(frame->intensity);
        free(frame);
    }
}

/* Whether all n depths are at least 0 and below the end; false for NaN and infinity. */
static bool depths_sane(const float *depth_mm, size_t n)
{
    const size_t n_lanes = n - n % ISO_DEPTHS;
    iso_depth_counts sane = {-1, -1, -1, -1};
    for (size_t i = 0; i < n_lanes; i += ISO_DEPTHS) {
        const iso_depths z = ISO_DEPTHS_LOAD(&depth_mm[i]);
        sane &= (z >= 0.0f) & (z < depth_end_mm);
    }
    bool all = (sane[0] & sane[1] & sane[2] & sane[3]) != 0;
    for (size_t i = n_lanes; i < n; i++) {
        all &= depth_mm[i] >= 0.0f && depth_mm[i] < depth_end_mm;
    }
    return all;
}

int iso_frame_check(const struct iso_frame *frame, struct iso_fault *fault)
{
    const int error = iso_camera_check(&frame->camera, fault);
    if (error) {
        return error;
    }
    if (!size_sane(frame->width_px, frame->height_px) || !frame->depth_mm) {
        return iso_fault_set(fault, -EINVAL, "frame size must be 1..8192 px");
    }
    if (frame->crop_x_px < 0 || frame->crop_y_px < 0 ||
        frame->crop_x_px > frame->camera.width_px - frame->width_px ||
        frame->crop_y_px > frame->camera.height_px - frame->height_px) {
        return iso_fault_set(fault, -EINVAL, "frame's window leaves the camera's image");
    }
    return depths_sane(frame->depth_mm, (size_t)frame->width_px * (size_t)frame->height_px)
               ? 0
               : iso_fault_set(fault, -EINVAL, "depth is negative, beyond 1 km or not a number");
}

struct iso_vec3 iso_frame_point_at(const struct iso_frame *frame, int column, int row)
{
    return iso_camera_back_project(&frame->camera, column + frame->crop_x_px,
                                   row + frame->crop_y_px,
                                   (double)iso_frame_depth_at(frame, column, row));
}
