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

/* The vertices of the mean face that are compared: all of them, or a selection that is spread
 * evenly. The first few, however many, are also spread evenly. */
struct iso_pose_vertices {
    int n;
    struct iso_vec3 *point_mm; /* [n], face frame */
    struct iso_vec3 *normal;   /* [n], unit, outward */
    double *weight;            /* [n], how much the place moves with identity and expression */
};

/* `count` vertices (0: all) of the region ISO_HEAD_FACE by farthest-point sampling; those that are
 * not ISO_HEAD_RIGID get `soft_weight`. -EINVAL if the model has no such region, -ENOMEM. */
int iso_pose_vertices_new(const struct iso_head_model *model, int count, double soft_weight,
                          struct iso_pose_vertices **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_pose_vertices_free(struct iso_pose_vertices *vertices);

struct iso_pose_options {
    int iterations;                         /* 1..64 */
    int vertices;                           /* compared at most; 0: all */
    double cutoff_first_mm, cutoff_last_mm; /* Tukey's cut-off, geometric between */
    double nose_sigma_mm;                   /* prior on the nose tip; 0: none */
    struct iso_vec3 nose_mm;                /* camera frame, where the prior wants it */
};

/* The limit of a squared residual in the cost of a fit. */
#define ISO_POSE_COST_LIMIT_MM2 36.0

struct iso_pose_fit {
    struct iso_rigid camera_from_face;
    double cost_mm2; /* mean of min(r^2, 36) over vertices with a measurement */
    double coverage; /* share of front-facing vertices that have a measurement */
    double in_image; /* share of front-facing vertices that project into the frame */
};

/* Starts from `start`. -ENODATA if fewer than 30 vertices meet a measurement or they do not fix a
 * pose. */
int iso_pose_fit(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                 const struct iso_pose_options *options, const struct iso_rigid *start,
                 struct iso_pose_fit *out) __attribute__((warn_unused_result));

#endif
