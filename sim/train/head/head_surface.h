/* The part of the head model that the trained model keeps: what is seen of a face from the front,
 * without holes. */
#ifndef SIM_TRAIN_HEAD_HEAD_SURFACE_H
#define SIM_TRAIN_HEAD_HEAD_SURFACE_H

#include <stdint.h>

#include "isotherm/landmark.h"
#include "isotherm/vec.h"
#include "sim/world/face/ict.h"

/* Where a vertex comes from: halfway between two vertices of the head model (mostly the same one
 * twice), moved by a constant. Being linear, it takes identity and expression modes along. */
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

/* Face, forehead, temples, cheeks and throat up to 114 mm from the nose tip as seen from the front,
 * without ears; eyes and lips are closed by a skin. -EINVAL with *fault for a head model whose
 * landmarks lie outside of that, or whose openings cannot be closed; -ENOMEM. */
int sim_head_surface_new(const struct sim_ict *ict, struct sim_head_surface **out,
                         struct iso_fault *fault) __attribute__((warn_unused_result));
void sim_head_surface_free(struct sim_head_surface *surface);

/* Drops the vertices that no triangle refers to and renumbers the rest. -EINVAL, with the surface
 * unchanged, if a landmark is among them; -ENOMEM. */
int sim_head_surface_compact(struct sim_head_surface *surface) __attribute__((warn_unused_result));

/* The head model's displacement field ([SIM_ICT_VERTICES][3]) at the surface's vertices. */
void sim_head_surface_displacement(const struct sim_head_surface *surface, const float *field_mm,
                                   float (*out_mm)[3]);

#endif
