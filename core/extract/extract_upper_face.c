#include <math.h>
#include <string.h>

#include "core/extract/extract_workspace.h"
#include "core/match/upper_face.h"

/* The patch's depth between its pixels, bilinear; 0 where there is none. */
static double depth_at(const struct iso_frame *grid, double column, double row)
{
    const int u = (int)floor(column), v = (int)floor(row), width = grid->width_px;
    if (u < 0 || v < 0 || u + 1 >= width || v + 1 >= grid->height_px) {
        return 0.0;
    }
    const double s = column - u, t = row - v;
    const double weight[4] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const float depth_mm = grid->depth_mm[(v + k / 2) * width + u + k % 2];
        if (weight[k] > 0.0 && !(depth_mm > 0.0f)) {
            return 0.0;
        }
        sum += weight[k] * (double)depth_mm;
    }
    return sum;
}

void iso__extract_upper_face(const struct iso_face_patch *patch, struct iso_upper_face *out)
{
    memset(out, 0, sizeof *out);
    for (int row = 0; row < ISO_UPPER_ROWS; row++) {
        for (int column = 0; column < ISO_UPPER_COLUMNS; column++) {
            const double x_mm = iso_upper_x_mm(column), y_mm = iso_upper_y_mm(row);
            double at_column, at_row;
            iso_face_patch_pixel(patch, x_mm, y_mm, &at_column, &at_row);
            const double depth_mm = depth_at(iso_face_patch_frame(patch), at_column, at_row);
            if (depth_mm > 0.0) {
                out->z_mm[row][column] = (float)(ISO_FACE_PATCH_ORIGIN_MM - depth_mm);
                out->kind[row][column] = iso_face_patch_measured(patch, x_mm, y_mm) > 0.5
                                             ? ISO_UPPER_MEASURED
                                             : ISO_UPPER_FILLED;
            }
        }
    }
}
