/* The regions of the head, and how much each vertex counts. */
#ifndef SIM_TRAIN_HEAD_HEAD_REGION_H
#define SIM_TRAIN_HEAD_HEAD_REGION_H

#include <stdbool.h>

#include "sim/train/head/head_surface.h"

/* Whether a vertex belongs to the face proper: within the head model's narrow face, brow to chin,
 * in front of the ears. */
bool sim_head_in_face(const struct sim_head_surface *surface, uint32_t vertex);

/* How much an error of the surface counts at each vertex when it is decimated: much around eyes,
 * nose and mouth, little outside of the face and where it is not exposed (head_exposure.h). */
void sim_head_importance(const struct sim_head_surface *surface, const double *exposure,
                         double *importance);

/* The area that each vertex stands for (a third of its triangles'), mm^2, where `region` has the
 * bit `wanted`, else 0. */
void sim_head_vertex_areas(const struct sim_head_surface *surface, const uint8_t *region,
                           uint8_t wanted, double *area_mm2);

/* Bits of enum iso_head_region for each vertex, given its exposure (head_exposure.h) and how far
 * expressions move it along the surface's normal, rms over the training set. */
void sim_head_regions(const struct sim_head_surface *surface, const double *exposure,
                      const double *expression_rms_mm, uint8_t *region);

#endif
