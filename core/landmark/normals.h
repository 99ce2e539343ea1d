/* Vertex normals of a head shape. */
#ifndef ISO_CORE_LANDMARK_NORMALS_H
#define ISO_CORE_LANDMARK_NORMALS_H

#include "isotherm/head_model.h"

/* Adds the normal of each triangle to the sum of each of its three corners. The length of a normal
 * is twice the area of its triangle, mm2. shape_mm and sum have an entry for each vertex; the
 * caller sets sum to zero before. */
void iso_triangle_normals(const uint32_t (*triangles)[3], uint32_t n_triangles,
                          const struct iso_vec3 *shape_mm, struct iso_vec3 *sum);

/* Area-weighted unit normals, outward; shape and normal are [model->n_vertices]. */
void iso_head_normals(const struct iso_head_model *model, const struct iso_vec3 *shape_mm,
                      struct iso_vec3 *normal);

#endif
