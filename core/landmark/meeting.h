/* How a point of the head model compares with the measurement: projective association, point to
 * plane. Inline, because a frame compares a hundred thousand points. Internal to core. */
#ifndef ISO_CORE_LANDMARK_MEETING_H
#define ISO_CORE_LANDMARK_MEETING_H

#include <stdbool.h>

#include "core/frame/distortion.h"
#include "isotherm/frame.h"

enum iso_meeting {
    ISO_MEETING_TURNED_AWAY, /* its normal is more than 75 degrees off the line of sight */
    ISO_MEETING_OUTSIDE,     /* it projects outside the frame */
    ISO_MEETING_UNMEASURED,  /* the frame has no depth where it appears */
    ISO_MEETING_MEASURED,    /* it is compared with a measured depth */
    ISO_MEETINGS             /* how many there are */
};

/* The cosine of the largest angle, 75 degrees, between a normal and the line of sight. */
static const double iso__facing_cosine = 0.26;
/* The four depths about a place belong to one surface if they differ by less than this. */
static const float iso__together_mm = 10.0f;

/* Conditional expressions, because fmin and fmax would be calls. */
static inline float iso__smaller(float a, float b)
{
    return a < b ? a : b;
}

static inline float iso__larger(float a, float b)
{
    return a > b ? a : b;
}

/* The depth at a position of the frame; 0 if there is none. column and row are not negative. */
static inline double iso__depth_between(const struct iso_frame *frame, double column, double row)
{
    int u = (int)column, v = (int)row;
    if (u < frame->width_px - 1 && v < frame->height_px - 1) {
        const float *at = &frame->depth_mm[(size_t)v * (size_t)frame->width_px + (size_t)u];
        const float *below = at + frame->width_px;
        const float low = iso__smaller(iso__smaller(at[0], at[1]),
                                       iso__smaller(below[0], below[1]));
        float high = iso__larger(iso__larger(at[0], at[1]), iso__larger(below[0], below[1]));
        if (low > 0.0f && high - low < iso__together_mm) {
            double s = column - u, t = row - v;
            return (1 - t) * ((1 - s) * (double)at[0] + s * (double)at[1]) +
                   t * ((1 - s) * (double)below[0] + s * (double)below[1]);
        }
    }
    return (double)iso_frame_depth_at(frame, (int)(column + 0.5), (int)(row + 0.5));
}

static inline bool iso__faces_away(const struct iso_frame *frame, struct iso_vec3 point,
                                   struct iso_vec3 normal)
{
    if (frame->camera.projection != ISO_PINHOLE) {
        return -normal.z < iso__facing_cosine;
    }
    const double toward = -iso_dot(normal, point);
    const double least = iso__facing_cosine * iso__facing_cosine * iso_dot(point, point);
    return toward <= 0.0 || toward * toward < least;
}

/* As iso_camera_project(), without a call if the camera has no distortion. */
static inline bool iso__meeting_project(const struct iso_camera *camera, struct iso_vec3 p,
                                        double *u_px, double *v_px)
{
    if (camera->projection != ISO_PINHOLE || iso_camera_is_distorted(camera)) {
        return iso_camera_project(camera, p, u_px, v_px);
    }
    if (!(p.z > 0.0)) {
        return false;
    }
    *u_px = camera->cx_px + camera->fx_px * (p.x / p.z);
    *v_px = camera->cy_px + camera->fy_px * (p.y / p.z);
    return true;
}

/* Compares a camera-frame point of the model, with its unit normal, with the frame. For
 * ISO_MEETING_MEASURED, *distance_mm becomes the distance of the point from the measured surface
 * along the normal: above 0 if the point lies before the surface. The depth is bilinear between
 * pixels of one surface, otherwise that of the nearest pixel. */
static inline __attribute__((always_inline)) enum iso_meeting iso_meet(
    const struct iso_frame *frame, struct iso_vec3 point, struct iso_vec3 normal,
    double *distance_mm)
{
    if (iso__faces_away(frame, point, normal)) {
        return ISO_MEETING_TURNED_AWAY;
    }
    double u, v;
    if (!iso__meeting_project(&frame->camera, point, &u, &v)) {
        return ISO_MEETING_OUTSIDE;
    }
    double column = u - frame->crop_x_px, row = v - frame->crop_y_px;
    if (!(column >= 0.0 && row >= 0.0 && column < frame->width_px - 0.5 &&
          row < frame->height_px - 0.5)) {
        return ISO_MEETING_OUTSIDE;
    }
    const double z = iso__depth_between(frame, column, row);
    if (!(z > 0.0)) {
        return ISO_MEETING_UNMEASURED;
    }
    /* The measured point lies on the line of sight of the model's point. */
    *distance_mm = frame->camera.projection == ISO_PINHOLE
                       ? iso_dot(normal, point) * (1.0 - z / point.z)
                       : normal.z * (point.z - z);
    return ISO_MEETING_MEASURED;
}

/* Tukey's biweight (Beaton and Tukey 1974): (1 - (r/c)^2)^2 within the cut-off, 0 beyond. No branch
 * depends on r, because half of the distances of a face lie beyond the cut-off. */
static inline double iso_tukey(double r, double cutoff)
{
    const double s = r / cutoff, rest = 1.0 - s * s, weight = rest > 0.0 ? rest : 0.0;
    return weight * weight;
}

#endif
