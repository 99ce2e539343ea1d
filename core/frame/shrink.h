/* A window of a frame at a coarser pitch. */
#ifndef ISO_CORE_FRAME_SHRINK_H
#define ISO_CORE_FRAME_SHRINK_H

#include "isotherm/frame.h"

/* A rectangle of a frame's pixels. */
struct iso_window {
    int column, row, width_px, height_px;
};

/* Shrinks a window of `frame` by a whole factor into `out`: width_px / factor by height_px / factor
 * pixels (a rest at the right and the bottom is left out); sets out's sizes, camera, times and
 * depth plane, not its intensity. Each new pixel is the mean of the depths of its block that lie
 * within 20 mm of the block's lower median, or 0 if fewer than a quarter of the block was measured:
 * so depth jumps stay sharp. The new camera sees the same rays (focal length and principal point
 * scaled), so that all of core works on shrunken frames as on any other. out->depth_mm has room for
 * capacity_px. -EINVAL if the window leaves the frame or the factor is outside 1..ISO_SHRINK_MAX,
 * -ENOSPC if the result has more than capacity_px pixels. */
enum { ISO_SHRINK_MAX = 16 };
int iso_frame_shrink(const struct iso_frame *frame, struct iso_window window, int factor,
                     size_t capacity_px, struct iso_frame *out) __attribute__((warn_unused_result));

#endif
