#include "core/landmark/meeting.h"

#include <stdbool.h>

/* The cosine of the largest angle, 75 degrees, between a normal and the line of sight. */
static const double facing_cosine = 0.26;
/* The four depths about a place belong to one surface if they differ by less than this. */
static const float together_mm = 10.0f;

/* Conditional expressions, because fmin and fmax would be calls, and this runs a hundred thousand
 * times a frame. */
static inline float smaller(float a, float b)
{
    return a < b ? a : b;
}

static inline float larger(float a, float b)
{
    return a > b ? a : b;
}

/* The depth at a position of the frame; 0 if there is none. column and row are not negative. */
static double depth_between(const struct iso_frame *frame, double column, double row)
{
    int u = (int)column, v = (int)row;
    if (u < frame->width_px - 1 && v < frame->height_px - 1) {
        const float *at = &frame->depth_mm[(size_t)v * (size_t)frame->width_px + (size_t)u];
        const float *below = at + frame->width_px;
        const float low = smaller(smaller(at[0], at[1]), smaller(below[0], below[1]));
        float high = larger(larger(at[0], at[1]), larger(below[0], below[1]));
        if (low > 0.0f && high - low < together_mm) {
            double s = column - u, t = row - v;
            return (1 - t) * ((1 - s) * (double)at[0] + s * (double)at[1]) +
                   t * ((1 - s) * (double)below[0] + s * (double)below[1]);
        }
    }
    return (double)iso_frame_depth_at(frame, (int)(column + 0.5), (int)(row + 0.5));
}

static bool faces_away(const struct iso_frame *frame, struct iso_vec3 point, struct iso_vec3 normal)
{
    if (frame->camera.projection != ISO_PINHOLE) {
        return -normal.z < facing_cosine;
    }
    const double toward = -iso_dot(normal, point);
    return toward <= 0.0 || toward * toward < facing_cosine * facing_cosine * iso_dot(point, point);
}

enum iso_meeting iso_meet(const struct iso_frame *frame, struct iso_vec3 point,
                          struct iso_vec3 normal, double *distance_mm)
{
    if (faces_away(frame, point, normal)) {
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
    const double z = depth_between(frame, column, row);
    if (!(z > 0.0)) {
        return ISO_MEETING_UNMEASURED;
    }
    /* The measured point lies on the line of sight of the model's point. */
    *distance_mm = frame->camera.projection == ISO_PINHOLE
                       ? iso_dot(normal, point) * (1.0 - z / point.z)
                       : normal.z * (point.z - z);
    return ISO_MEETING_MEASURED;
}
