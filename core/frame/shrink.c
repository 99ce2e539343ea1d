#include "core/frame/shrink.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/frame/shrink_blocks.h"

/* The depth of the new pixel for the block at (column, row); 0 if too little of it was measured. */
static float block_depth(const struct iso_frame *frame, int column, int row, int factor)
{
    float sorted[ISO_SHRINK_MAX * ISO_SHRINK_MAX];
    int n = 0;
    for (int v = row; v < row + factor; v++) {
        for (int u = column; u < column + factor; u++) {
            const float z = iso_frame_depth_at(frame, u, v);
            if (!(z > 0.0f)) {
                continue;
            }
            int i = n++;
            for (; i > 0 && sorted[i - 1] > z; i--) {
                sorted[i] = sorted[i - 1];
            }
            sorted[i] = z;
        }
    }
    if (n == 0 || 4 * n < factor * factor) {
        return 0.0f;
    }
    float median = sorted[(n - 1) / 2], sum = 0.0f;
    int used = 0;
    for (int i = 0; i < n; i++) {
        if (fabsf(sorted[i] - median) <= ISO_SHRINK_SAME_MM) {
            sum += sorted[i];
            used++;
        }
    }
    return sum / (float)used;
}

/* The camera of the shrunken frame: the centre of its pixel (i, j) is the centre of the block of
 * old pixels that begins at (i, j) * factor in the window. */
static struct iso_camera shrunken_camera(const struct iso_frame *frame, struct iso_window window,
                                         int factor)
{
    struct iso_camera c = frame->camera;
    const double shift = (factor - 1) / 2.0;
    c.cx_px = (c.cx_px - frame->crop_x_px - window.column - shift) / factor;
    c.cy_px = (c.cy_px - frame->crop_y_px - window.row - shift) / factor;
    c.fx_px /= factor;
    c.fy_px /= factor;
    c.pitch_mm *= factor;
    c.width_px = window.width_px / factor;
    c.height_px = window.height_px / factor;
    return c;
}

int iso_frame_shrink(const struct iso_frame *frame, struct iso_window window, int factor,
                     size_t capacity_px, struct iso_frame *out)
{
    const bool inside = window.column >= 0 && window.row >= 0 &&
                        window.column + window.width_px <= frame->width_px &&
                        window.row + window.height_px <= frame->height_px;
    if (!inside || factor < 1 || factor > ISO_SHRINK_MAX || window.width_px < factor ||
        window.height_px < factor) {
        return -EINVAL;
    }
    int width = window.width_px / factor, height = window.height_px / factor;
    if ((size_t)width * (size_t)height > capacity_px) {
        return -ENOSPC;
    }
    out->camera = shrunken_camera(frame, window, factor);
    out->width_px = width;
    out->height_px = height;
    out->crop_x_px = out->crop_y_px = 0;
    out->t_ns = frame->t_ns;
    out->sequence = frame->sequence;
    float *depth = out->depth_mm;
    for (int row = 0; row < height; row++) {
        const int top = window.row + row * factor;
        const float *line =
            &frame->depth_mm[(size_t)top * (size_t)frame->width_px + (size_t)window.column];
        if (factor == 1) {
            memcpy(depth, line, (size_t)width * sizeof *depth);
            depth += width;
            continue;
        }
        int column = factor == ISO_SHRINK_USUAL
                         ? iso_shrink_blocks(line, frame->width_px, width, depth)
                         : 0;
        for (; column < width; column++) {
            depth[column] = block_depth(frame, window.column + column * factor, top, factor);
        }
        depth += width;
    }
    return 0;
}
