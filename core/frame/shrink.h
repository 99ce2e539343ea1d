/* A window of a frame at a coarser pitch. */
#ifndef ISO_CORE_FRAME_SHRINK_H
#define ISO_CORE_FRAME_SHRINK_H

#include "isotherm/frame.h"

/* A rectangle of a frame's pixels. */
struct iso_window {
    int column, row, width_px, height_px;
};

/* Shrinks a window of `frame` by a whole factor into `out`. The result has width_px / factor by
 * height_px / factor pixels; remaining pixels at the right and the bottom are left out.
 *
 * A new pixel is 0 if fewer than a quarter of the pixels of its block were measured. Otherwise it
 * is the mean of those measured depths that lie within 20 mm of their lower median, so that depth
 * jumps stay sharp. The new camera sees the same rays (its focal length and principal point are
 * scaled), so that all of core works on a shrunken frame as on any other one.
 *
 * Sets the sizes, the camera, t_ns, sequence, the crop (to 0) and the depth plane of out, but not
 * its intensity. out->depth_mm has room for capacity_px pixels. -EINVAL if the window leaves the
 * frame or is smaller than one block, or if the factor is outside 1..ISO_SHRINK_MAX. -ENOSPC if the
 * result has more than capacity_px pixels. */
enum { ISO_SHRINK_MAX = 16 };
int iso_frame_shrink(const struct iso_frame *frame, struct iso_window window, int factor,
                     size_t capacity_px, struct iso_frame *out) __attribute__((warn_unused_result));

#endif
