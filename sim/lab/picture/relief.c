#include "sim/lab/picture/relief.h"

#include <math.h>

/* Sums over the neighbours of a pixel, relative to it. */
struct moments {
    double n, x, y, z, xx, xy, yy, xz, yz;
};

static struct moments moments_about(const struct iso_frame *frame, int column, int row, int reach)
{
    const double jump_mm = 30.0;
    const double middle = (double)iso_frame_depth_at(frame, column, row);
    struct moments m = {0};
    for (int dy = -reach; dy <= reach; dy++) {
        for (int dx = -reach; dx <= reach; dx++) {
            const int c = column + dx, r = row + dy;
            const bool inside = c >= 0 && r >= 0 && c < frame->width_px && r < frame->height_px;
            const double depth = inside ? (double)iso_frame_depth_at(frame, c, r) : 0.0;
            if (depth > 0.0 && fabs(depth - middle) < jump_mm) {
                const double z = depth - middle;
                m.n += 1.0;
                m.x += dx;
                m.y += dy;
                m.z += z;
                m.xx += dx * dx;
                m.xy += dx * dy;
                m.yy += dy * dy;
                m.xz += dx * z;
                m.yz += dy * z;
            }
        }
    }
    return m;
}

float sim_relief(const struct iso_frame *frame, int column, int row, int reach_px)
{
    const double flat = 0.75;
    struct moments m = moments_about(frame, column, row, reach_px);
    const double xx = m.xx - m.x * m.x / m.n, xy = m.xy - m.x * m.y / m.n,
                 yy = m.yy - m.y * m.y / m.n;
    const double xz = m.xz - m.x * m.z / m.n, yz = m.yz - m.y * m.z / m.n;
    double determinant = xx * yy - xy * xy, slope_x = 0.0, slope_y = 0.0;
    if (determinant > 1e-6) {
        const double pixel_mm = iso_camera_pixel_mm(&frame->camera,
                                                    (double)iso_frame_depth_at(frame, column, row));
        slope_x = (xz * yy - yz * xy) / determinant / pixel_mm;
        slope_y = (yz * xx - xz * xy) / determinant / pixel_mm;
    }
    /* The normal (slope_x, slope_y, -1) and the light (-1, -1, -2) / sqrt 6. */
    const double lambert = (2.0 - slope_x - slope_y) /
                           sqrt(6.0 * (1.0 + slope_x * slope_x + slope_y * slope_y));
    return (float)fmin(fmax(0.15 + lambert * flat / 0.8165 * 0.85, 0.1), 1.0);
}

bool sim_relief_place(const struct iso_frame *frame, struct iso_vec3 point_mm, double *x, double *y)
{
    if (!iso_camera_project(&frame->camera, point_mm, x, y)) {
        return false;
    }
    *x += 0.5 - frame->crop_x_px;
    *y += 0.5 - frame->crop_y_px;
    return true;
}

double sim_relief_nearest_mm(const struct iso_frame *frame)
{
    const size_t n = (size_t)frame->width_px * (size_t)frame->height_px;
    double nearest_mm = INFINITY;
    for (size_t i = 0; i < n; i++) {
        const double depth_mm = (double)frame->depth_mm[i];
        nearest_mm = depth_mm > 0.0 ? fmin(nearest_mm, depth_mm) : nearest_mm;
    }
    return nearest_mm;
}

int sim_relief_reach_px(const struct iso_frame *frame, double depth_mm)
{
    const double reach_px = 4.0 / iso_camera_pixel_mm(&frame->camera, depth_mm);
    return (int)fmin(fmax(rint(reach_px), 1.0), 4.0);
}
