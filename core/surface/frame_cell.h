/* The triangles of one cell (cell.h) of a depth frame, and the points of its corners. */
#ifndef ISO_CORE_SURFACE_FRAME_CELL_H
#define ISO_CORE_SURFACE_FRAME_CELL_H

#include <stddef.h>

#include "core/frame/distortion.h"
#include "core/surface/cell.h"

struct iso_frame_cell {
    struct iso_cell_list triangles;
    struct iso_vec3 point[4]; /* of the corners, camera frame; only if there is a triangle */
};

/* The cell whose corner 0 is the pixel at (column, row), which is not in the last column or row of
 * the frame. If all corners were measured, it is divided along its shorter diagonal. Triangles that
 * span more than jump_mm of depth are left out. */
static inline struct iso_frame_cell iso_frame_cell(const struct iso_frame *frame, int column,
                                                   int row, double jump_mm)
{
    struct iso_frame_cell cell = {.triangles = {0}};
    const float *at = &frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)column];
    const float z[4] = {at[0], at[1], at[frame->width_px], at[frame->width_px + 1]};
    const int measured = (z[0] > 0) + (z[1] > 0) + (z[2] > 0) + (z[3] > 0);
    if (measured < 3) {
        return cell;
    }
    for (int k = 0; k < 4; k++) {
        cell.point[k] = iso_frame_point_quick(frame, column + (k & 1), row + (k >> 1));
    }
    const struct iso_vec3 rising = iso_sub(cell.point[1], cell.point[2]);
    const struct iso_vec3 falling = iso_sub(cell.point[0], cell.point[3]);
    const bool rises = measured == 4 && iso_dot(rising, rising) < iso_dot(falling, falling);
    cell.triangles = iso_cell_list(iso_cell_set(z, rises, jump_mm));
    return cell;
}

#endif
