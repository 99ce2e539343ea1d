/* How a point of the head model compares with the measurement: projective association, point to
 * plane. Internal to core. */
#ifndef ISO_CORE_LANDMARK_MEETING_H
#define ISO_CORE_LANDMARK_MEETING_H

#include "isotherm/frame.h"

enum iso_meeting {
    ISO_MEETING_TURNED_AWAY, /* its normal is more than 75 degrees off the line of sight */
    ISO_MEETING_OUTSIDE,     /* it projects outside the frame */
    ISO_MEETING_UNMEASURED,  /* the frame has no depth where it appears */
    ISO_MEETING_MEASURED,    /* it is compared with a measured depth */
    ISO_MEETINGS             /* how many there are */
};

/* Compares a camera-frame point of the model, with its unit normal, with the frame. For
 * ISO_MEETING_MEASURED, *distance_mm becomes the distance of the point from the measured surface
 * along the normal: above 0 if the point lies before the surface. The depth is bilinear between
 * pixels of one surface, otherwise that of the nearest pixel. */
enum iso_meeting iso_meet(const struct iso_frame *frame, struct iso_vec3 point,
                          struct iso_vec3 normal, double *distance_mm);

/* Tukey's biweight (Beaton and Tukey 1974): (1 - (r/c)^2)^2 within the cut-off, 0 beyond. */
static inline double iso_tukey(double r, double cutoff)
{
    double s = r / cutoff;
    return fabs(s) < 1.0 ? (1.0 - s * s) * (1.0 - s * s) : 0.0;
}

#endif
