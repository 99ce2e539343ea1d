/* The part of the head model that the trained model keeps: the surface of the face that is
 * visible from the front, without holes. */
#ifndef SIM_TRAIN_HEAD_HEAD_SURFACE_H
#define SIM_TRAIN_HEAD_HEAD_SURFACE_H

#include <stdint.h>

#include "isotherm/landmark.h"
#include "isotherm/vec.h"
#include "sim/world/face/ict.h"

/* The origin of a vertex: halfway between two vertices of the head model (mostly the same one
 * twice), moved by a constant. This is linear, so that identity and expression modes apply to it
 * as well. */
struct sim_head_vertex {
    uint32_t source[2]; /* vertices of the head model */
    struct iso_vec3 offset_mm;
};

struct sim_head_surface {
    uint32_t n_vertices, n_triangles;
    struct sim_head_vertex *vertices;
    struct iso_vec3 *mean_mm;               /* [n_vertices], face frame */
    uint32_t (*triangles)[3];               /* counter-clockwise seen from outside */
    uint32_t landmarks[ISO_LANDMARKS_IBUG]; /* vertices of the surface */
};

/* Face, forehead, temples, cheeks and throat up to 114 mm from the nose tip as seen from the
 * front, without ears. Eyes and lips are closed by a skin. -EINVAL with *fault for a head model
 * with landmarks outside this part or with openings that cannot be closed; -ENOMEM. */
int sim_head_surface_new(const struct sim_ict *ict, struct sim_head_surface **out,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_head_surface_free(struct sim_head_surface *surface);

/* Removes the vertices without triangles and renumbers the others. -EINVAL if a landmark is
 * among the removed vertices, and the surface is then unchanged; -ENOMEM. */
int sim_head_surface_compact(struct sim_head_surface *surface) __attribute__((warn_unused_result));

/* Evaluates a displacement field of the head model ([SIM_ICT_VERTICES][3]) at the surface's
 * vertices. */
void sim_head_surface_displacement(const struct sim_head_surface *surface, const float *field_mm,
                                   float (*out_mm)[3]);

#endif
