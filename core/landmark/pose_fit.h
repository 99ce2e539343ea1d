/* Rigid robust registration of the mean face to a depth frame.
 *
 * Point to plane with projective association (Blais and Levine 1995; Chen and Medioni 1992): each
 * front-facing vertex of the mean face is compared with the measured point at the pixel to which it
 * projects, along the normal of the model, which has no noise. Gauss-Newton on the six degrees of
 * freedom with Tukey's biweight (Beaton and Tukey 1974), whose cut-off falls from step to step. */
#ifndef ISO_CORE_LANDMARK_POSE_FIT_H
#define ISO_CORE_LANDMARK_POSE_FIT_H

#include "isotherm/frame.h"
#include "isotherm/head_model.h"

struct iso_meet_points;

/* The vertices of the mean face that are compared: all of them, or a selection that is spread
 * evenly. The first few, however many, are also spread evenly. */
struct iso_pose_vertices {
    int n;
    struct iso_meet_points *points; /* groups of ISO_MEET_MANY vertices (meet_many.h) */
    double *weight; /* [n], 1 for vertices of ISO_HEAD_RIGID, else the soft weight */
};

/* Chooses `count` vertices (0: all) of the region ISO_HEAD_FACE by farthest-point sampling. Those
 * that are not ISO_HEAD_RIGID get the weight `soft_weight`. -EINVAL if the model has no such
 * region, or if count or soft_weight is below 0; -ENOMEM. */
int iso_pose_vertices_new(const struct iso_head_model *model, int count, double soft_weight,
                          struct iso_pose_vertices **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_pose_vertices_free(struct iso_pose_vertices *vertices);

struct iso_pose_options {
    int iterations;                         /* 1..64 */
    int vertices;                           /* most vertices that are compared; 0: all */
    double cutoff_first_mm, cutoff_last_mm; /* Tukey's cut-off falls geometrically between these */
    double nose_sigma_mm;                   /* standard deviation of the nose tip; 0: no prior */
    struct iso_vec3 nose_mm;                /* expected position of the nose tip, camera frame */
};

/* The limit of a squared residual in the cost of a fit. */
#define ISO_POSE_COST_LIMIT_MM2 36.0

struct iso_pose_fit {
    struct iso_rigid camera_from_face;
    double cost_mm2; /* mean of min(r^2, 36) over vertices with a measurement */
    double coverage; /* share of front-facing vertices that have a measurement */
    double in_image; /* share of front-facing vertices that project into the frame */
};

/* Registers the mean face to the frame, beginning at the pose `start`. -ENODATA if fewer than 30
 * vertices meet a measurement, or if these do not determine a pose. */
int iso_pose_fit(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                 const struct iso_pose_options *options, const struct iso_rigid *start,
                 struct iso_pose_fit *out) __attribute__((warn_unused_result));

#endif
