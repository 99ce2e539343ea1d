/* Measures how well a trained head model describes faces: the distances that decimation causes,
 * and the residual for people outside the training set. */
#ifndef SIM_TRAIN_HEAD_TRAIN_MEASURE_H
#define SIM_TRAIN_HEAD_TRAIN_MEASURE_H

#include "sim/train/head/head_surface.h"

struct sim_distances {
    double mean_mm, p95_mm, max_mm;
};

/* Distances from the exposed face vertices (head_exposure.h) of the fine surface to the coarse
 * surface. -ENOMEM. */
int sim_surface_distances(const struct sim_head_surface *fine, const double *exposure,
                          const struct sim_head_surface *coarse, struct sim_distances *out)
    __attribute__((warn_unused_result));

/* Root mean squares over the weighted vertices and over 200 people of the population "test":
 * before_mm is the deviation from the mean face, after_mm the residual after projection to the
 * components. `fields_mm` are the identity fields, [SIM_IDENTITY_MODES][n_vertices][3];
 * components and `variance` come from sim_principal. -ENOMEM. */
struct sim_rms {
    double before_mm, after_mm;
};
int sim_unseen_people(const float *fields_mm, uint32_t n_vertices, const double *weight,
                      const float *components_mm, const double *variance, uint32_t n_components,
                      uint64_t seed, struct sim_rms *out) __attribute__((warn_unused_result));

#endif
