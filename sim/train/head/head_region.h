/* The regions of the head, and the weights of its vertices. */
#ifndef SIM_TRAIN_HEAD_HEAD_REGION_H
#define SIM_TRAIN_HEAD_HEAD_REGION_H

#include <stdbool.h>

#include "sim/train/head/head_surface.h"

/* Whether a vertex belongs to the face: within the head model's narrow face, from 70 mm above the
 * nose tip (on the forehead) to just under the chin, in front of the ears. */
bool sim_head_in_face(const struct sim_head_surface *surface, uint32_t vertex);

/* Sets the weight of a surface error at each vertex during decimation. It is high around brows,
 * eyes, nose and mouth, and low outside the face and where the surface is not exposed
 * (head_exposure.h). */
void sim_head_importance(const struct sim_head_surface *surface, const double *exposure,
                         double *importance);

/* Sets the area of each vertex (a third of its triangles' areas), mm^2, where `region` has the bit
 * `wanted`, otherwise 0. */
void sim_head_vertex_areas(const struct sim_head_surface *surface, const uint8_t *region,
                           uint8_t wanted, double *area_mm2);

/* Sets the bits of enum iso_head_region for each vertex, from its exposure (head_exposure.h) and
 * its movement by expressions along the surface's normal, rms over the training set. */
void sim_head_regions(const struct sim_head_surface *surface, const double *exposure,
                      const double *expression_rms_mm, uint8_t *region);

#endif
