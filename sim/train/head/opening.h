/* Closes the openings in a mesh of the face: the eyes and the mouth. */
#ifndef SIM_TRAIN_HEAD_OPENING_H
#define SIM_TRAIN_HEAD_OPENING_H

#include <stddef.h>

#include "sim/train/head/head_surface.h"

/* A surface under construction; the arrays have room for additions. */
struct sim_surface_builder {
    struct sim_head_surface *surface;
    uint32_t vertex_capacity, triangle_capacity;
};

/* Append a vertex (and compute its mean_mm) or a triangle. -ENOSPC if the arrays are full. */
int sim_surface_add_vertex(struct sim_surface_builder *builder, const struct sim_ict *ict,
                           struct sim_head_vertex vertex) __attribute__((warn_unused_result));
int sim_surface_add_triangle(struct sim_surface_builder *builder, uint32_t a, uint32_t b,
                             uint32_t c) __attribute__((warn_unused_result));

/* Closes every hole of the surface except the one with the longest rim, which is its outer edge.
 * A strip of triangles joins the upper and the lower half of a rim. If an eyeball lies behind
 * the hole, the strip passes through a row of additional vertices. Each is halfway between the
 * lids, moves with them, and has the eyeball's depth in the mean face. -ENOSPC, -ENOMEM; -EINVAL
 * for a rim that is not a simple loop, or for more than 16 rims. */
int sim_close_openings(struct sim_surface_builder *builder, const struct sim_ict *ict)
    __attribute__((warn_unused_result));

#endif
