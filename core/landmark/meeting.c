#include "core/landmark/meeting.h"

#include <math.h>

static const double facing_cosine = 0.26;
/* Depths about a place belong to one surface if they differ by less. */
static const double together_mm = 10.0;

static double depth_between(const struct iso_frame *frame, double column, double row)
{
    int u = (int)floor(column), v = (int)floor(row);
    if (u < frame->width_px - 1 && v < frame->height_px - 1) {
        double a = (double)iso_frame_depth_at(frame, u, v);
        double b = (double)iso_frame_depth_at(frame, u + 1, v);
        double c = (double)iso_frame_depth_at(frame, u, v + 1);
        double d = (double)iso_frame_depth_at(frame, u + 1, v + 1);
        double low = fmin(fmin(a, b), fmin(c, d)), high = fmax(fmax(a, b), fmax(c, d));
        if (low > 0.0 && high - low < together_mm) {
            double s = column - u, t = row - v;
            return (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * c + s * d);
        }
    }
    return (double)iso_frame_depth_at(frame, (int)(column + 0.5), (int)(row + 0.5));
}

enum iso_meeting iso_meet(const struct iso_frame *frame, struct iso_vec3 point,
                          struct iso_vec3 normal, double *distance_mm)
{
    double toward = frame->camera.projection == ISO_PINHOLE
                        ? -iso_dot(normal, point) / iso_norm(point)
                        : -normal.z;
    if (toward < facing_cosine) {
        return ISO_MEETING_TURNED_AWAY;
    }
    double u, v;
    if (!iso_camera_project(&frame->camera, point, &u, &v)) {
        return ISO_MEETING_OUTSIDE;
    }
    double column = u - frame->crop_x_px, row = v - frame->crop_y_px;
    if (!(column >= 0.0 && row >= 0.0 && column < frame->width_px - 0.5 &&
          row < frame->height_px - 0.5)) {
        return ISO_MEETING_OUTSIDE;
    }
    double z = depth_between(frame, column, row);
    if (!(z > 0.0)) {
        return ISO_MEETING_UNMEASURED;
    }
    /* What is measured lies on the point's own line of sight. */
    *distance_mm = frame->camera.projection == ISO_PINHOLE
                       ? iso_dot(normal, point) * (1.0 - z / point.z)
                       : normal.z * (point.z - z);
    return ISO_MEETING_MEASURED;
}
