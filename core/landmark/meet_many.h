/* Compares many points of the head model with the frame, with the results of iso_meet() and
 * iso_tukey() for each (meeting.h). Several points share a register, and no branch depends on one
 * of them: a fit compares points of which some are turned away and some were not measured, and a
 * processor cannot guess which. Internal to core/landmark. */
#ifndef ISO_CORE_LANDMARK_MEET_MANY_H
#define ISO_CORE_LANDMARK_MEET_MANY_H

#include <stdint.h>

#include "isotherm/frame.h"

/* The most points of one call, and the points of a group. */
enum { ISO_MEET_MANY = 32, ISO_MEET_GROUP = 4 };

/* Points of the model in the face frame, and their unit normals: [axis][point]. */
struct iso_meet_points {
    double point_mm[3][ISO_MEET_MANY], normal[3][ISO_MEET_MANY];
};

/* Sets point i. */
static inline void iso_meet_points_set(struct iso_meet_points *points, int i, struct iso_vec3 point,
                                       struct iso_vec3 normal)
{
    points->point_mm[0][i] = point.x;
    points->point_mm[1][i] = point.y;
    points->point_mm[2][i] = point.z;
    points->normal[0][i] = normal.x;
    points->normal[1][i] = normal.y;
    points->normal[2][i] = normal.z;
}

/* Fills the last group behind n points with points that are turned away. */
static inline void iso_meet_points_fill(struct iso_meet_points *points, int n)
{
    for (int i = n; i % ISO_MEET_GROUP != 0; i++) {
        iso_meet_points_set(points, i, iso_vec3(0, 0, 0), iso_vec3(0, 0, 0));
    }
}

/* How they compare with a frame. */
struct iso_meetings {
    double normal[3][ISO_MEET_MANY]; /* camera frame */
    /* How the point moves along the normal if the head turns about the axes of the camera frame:
     * the vector product of the turned point and the normal, mm per radian. */
    double turn_mm[3][ISO_MEET_MANY];
    double distance_mm[ISO_MEET_MANY]; /* as of iso_meet(); 0 if it was not measured */
    double weight[ISO_MEET_MANY];   /* of the distance by iso_tukey(); 0 if it was not measured */
    int64_t meeting[ISO_MEET_MANY]; /* enum iso_meeting */
};

/* Compares the first n points at a pose, n <= ISO_MEET_MANY, with the cut-off of the weights. The
 * last group of points must be set to its end. Only the first n entries of *out have a meaning. */
void iso_meet_many(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                   const struct iso_meet_points *points, int n, double cutoff_mm,
                   struct iso_meetings *out);

/* The same by iso_meet(), point by point: for cameras that distort, for orthographic ones, and for
 * frames of a single row or column. */
void iso__meet_many_plain(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                          const struct iso_meet_points *points, int n, double cutoff_mm,
                          struct iso_meetings *out);

/* The same for each kind of processor, for other frames. The results are the same to the bit. (On
 * arm64 the compiler may join a product and a sum into one instruction, in one of them and not in
 * the other.) */
typedef void iso_meet_many_function(const struct iso_frame *frame,
                                    const struct iso_rigid *camera_from_face,
                                    const struct iso_meet_points *points, int n, double cutoff_mm,
                                    struct iso_meetings *out);

iso_meet_many_function iso__meet_many_baseline;
iso_meet_many_function iso__meet_many_avx2; /* x86-64 only */

#endif
