/* Vertex normals of a head shape. */
#ifndef ISO_CORE_LANDMARK_NORMALS_H
#define ISO_CORE_LANDMARK_NORMALS_H

#include "isotherm/head_model.h"

/* Adds the normal of each triangle, twice its area long, to the sums of its corners. */
void iso_triangle_normals(const uint32_t (*triangles)[3], uint32_t n_triangles,
                          const struct iso_vec3 *shape_mm, struct iso_vec3 *sum);

/* Area-weighted unit normals, outward; shape and normal are [model->n_vertices]. */
void iso_head_normals(const struct iso_head_model *model, const struct iso_vec3 *shape_mm,
                      struct iso_vec3 *normal);

#endif
