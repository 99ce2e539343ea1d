/* Trains the compact head model (isotherm/head_model.h) from the statistical head model. */
#ifndef SIM_TRAIN_HEAD_TRAIN_HEAD_H
#define SIM_TRAIN_HEAD_TRAIN_HEAD_H

#include "isotherm/head_model.h"
#include "sim/world/face/ict.h"

struct sim_train_head_options {
    uint64_t seed;         /* of the random expressions in the training set */
    uint32_t n_vertices;   /* of the result */
    uint32_t n_identity;   /* modes to keep */
    uint32_t n_expression; /* modes to keep */
};

/* Seed 1, 1180 vertices, 60 + 12 modes: a file of 540 KB. */
struct sim_train_head_options sim_train_head_options_default(void);

/* The result. Shares of variance and rms values are over the region ISO_HEAD_FACE, weighted by
 * area. The errors of decimation are those of sim_surface_distances, without weights. */
struct sim_train_head_report {
    uint32_t n_fine_vertices; /* before decimation */
    uint32_t n_face, n_rigid; /* vertices of the regions */
    double decimation_mean_mm, decimation_p95_mm,
        decimation_max_mm;                           /* fine vertex to coarse mesh */
    double identity_explained, expression_explained; /* shares of variance, 0..1 */
    double identity_rms_mm;                          /* deviation of people from the mean */
    double unseen_rms_mm;     /* residual after the modes, for people outside the training set */
    double expression_rms_mm; /* movement of the face by expressions */
    double expression_left_rms_mm; /* residual after the modes */
};

/* Keeps the front of the head (head_surface.h), and decimates it but keeps all 68 landmarks. Takes
 * the principal components of identity and of seeded random expressions, both without rigid motion
 * of the region ISO_HEAD_RIGID. The same arguments give the same model. -EINVAL for an unsuitable
 * head model or unsuitable options; -EDOM as sim_remove_rigid; -ENOMEM; each with a fault. */
int sim_train_head(const struct sim_ict *ict, const struct sim_train_head_options *options,
                   struct iso_head_model **out, struct sim_train_head_report *report,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
