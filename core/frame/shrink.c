#include "core/frame/shrink.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/frame/sort_lanes.h"

/* Depths further than this from the block's median belong to another surface. */
static const float same_surface_mm = 20.0f;

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
        if (fabsf(sorted[i] - median) <= same_surface_mm) {
            sum += sorted[i];
            used++;
        }
    }
    return sum / (float)used;
}

/* The usual block, for which four blocks are shrunk at once; it has BLOCK pixels. */
enum { USUAL = 4, BLOCK = USUAL * USUAL };

/* Reads a row of four blocks that lie side by side: lane k of vector j is pixel j of block k. */
static void read_row(const float *at, iso_depths pixel[USUAL])
{
    const iso_depths a = ISO_DEPTHS_LOAD(at), b = ISO_DEPTHS_LOAD(at + USUAL);
    const iso_depths c = ISO_DEPTHS_LOAD(at + 2 * USUAL), d = ISO_DEPTHS_LOAD(at + 3 * USUAL);
    const iso_depths ab_left = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const iso_depths ab_right = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const iso_depths cd_left = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const iso_depths cd_right = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    pixel[0] = __builtin_shufflevector(ab_left, cd_left, 0, 1, 4, 5);
    pixel[1] = __builtin_shufflevector(ab_left, cd_left, 2, 3, 6, 7);
    pixel[2] = __builtin_shufflevector(ab_right, cd_right, 0, 1, 4, 5);
    pixel[3] = __builtin_shufflevector(ab_right, cd_right, 2, 3, 6, 7);
}

/* Depths that were not measured become infinite, so that they are sorted to the end. Returns how
 * many of each block were measured. */
static iso_depth_counts set_apart_unmeasured(iso_depths pixel[BLOCK])
{
    const iso_depths never = {INFINITY, INFINITY, INFINITY, INFINITY};
    iso_depth_counts measured = {0};
    for (int i = 0; i < BLOCK; i++) {
        const iso_depth_counts is = pixel[i] > 0.0f;
        measured -= is;
        pixel[i] = iso_depths_choose(is, pixel[i], never);
    }
    return measured;
}

/* Does for four blocks what block_depth() does for one: the same sums in the same order. */
static void shrink_four_blocks(const float *at, int width_px, float out[ISO_DEPTHS])
{
    iso_depths sorted[BLOCK], sum = {0.0f};
    for (int row = 0; row < USUAL; row++) {
        read_row(&at[row * width_px], &sorted[row * USUAL]);
    }
    const iso_depth_counts measured = set_apart_unmeasured(sorted);
    iso_depth_counts used = {0};
    iso_sort_lanes_16(sorted);
    iso_depths median = sorted[0];
    for (int i = 1; i <= (BLOCK - 1) / 2; i++) {
        median = iso_depths_choose(2 * i < measured, sorted[i], median);
    }
    for (int i = 0; i < BLOCK; i++) {
        const iso_depths apart = sorted[i] - median;
        const iso_depth_counts same = (apart <= same_surface_mm) & (apart >= -same_surface_mm);
        sum += (iso_depths)((iso_depth_counts)sorted[i] & same);
        used -= same;
    }
    const iso_depths mean = sum / __builtin_convertvector(used, iso_depths);
    const iso_depth_counts enough = 4 * measured >= BLOCK;
    ISO_DEPTHS_STORE(out, (iso_depths)((iso_depth_counts)mean & enough));
}

/* Shrinks the first blocks of a row of blocks. Returns how many: none if they are not the usual
 * ones. The caller shrinks the others. */
static int shrink_usual_blocks(const float *at, int width_px, int factor, int n_blocks, float *out)
{
    const int n = factor == USUAL ? n_blocks - n_blocks % ISO_DEPTHS : 0;
    for (int i = 0; i < n; i += ISO_DEPTHS) {
        shrink_four_blocks(&at[i * USUAL], width_px, &out[i]);
    }
    return n;
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
        int column = shrink_usual_blocks(line, frame->width_px, factor, width, depth);
        for (; column < width; column++) {
            depth[column] = block_depth(frame, window.column + column * factor, top, factor);
        }
        depth += width;
    }
    return 0;
}
