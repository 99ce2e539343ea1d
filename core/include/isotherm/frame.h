/* One depth frame: a plane of depths, what camera saw it, and when.
 *
 * The plane is a window of the camera's image: frame pixel (column, row) is camera pixel
 * (column + crop_x_px, row + crop_y_px). Depth is along the optical axis in millimetres; 0 means
 * not measured, and nothing else does: NaN, infinite and negative depths are refused on entry by
 * iso_frame_check, so that every later step may test `> 0` alone. */
#ifndef ISOTHERM_FRAME_H
#define ISOTHERM_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "isotherm/camera.h"

struct iso_frame {
    struct iso_camera camera;
    int width_px, height_px;  /* of the planes */
    int crop_x_px, crop_y_px; /* the window's corner in the camera's image */
    int64_t t_ns;             /* monotonic time of exposure, nanoseconds */
    uint64_t sequence;        /* counts the sensor's frames; a gap is a lost frame */
    float *depth_mm;          /* [height_px * width_px], row by row */
    float *intensity;         /* the same shape, registered, 0..1; NULL if the sensor has none */
};

/* A frame with zeroed planes of the given size; the camera is copied, the crop is 0. -EINVAL for a
 * size outside 1..8192, -ENOMEM. Free with iso_frame_free. */
int iso_frame_new(const struct iso_camera *camera, int width_px, int height_px, bool with_intensity,
                  struct iso_frame **out) __attribute__((warn_unused_result));
void iso_frame_free(struct iso_frame *frame);

/* Whether the frame can be worked on: camera, size and crop sane, every depth finite and >= 0.
 * Returns 0, or -EINVAL with *fault (if not NULL) set to a static text. */
int iso_frame_check(const struct iso_frame *frame, const char **fault)
    __attribute__((warn_unused_result));

static inline float iso_frame_depth_at(const struct iso_frame *frame, int column, int row)
{
    return frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)column];
}

/* The camera-frame point of a pixel of the frame; call only where the depth is > 0. */
struct iso_vec3 iso_frame_point_at(const struct iso_frame *frame, int column, int row);

#endif
