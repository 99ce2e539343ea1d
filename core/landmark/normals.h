/* Vertex normals of a head shape. */
#ifndef ISO_CORE_LANDMARK_NORMALS_H
#define ISO_CORE_LANDMARK_NORMALS_H

#include "isotherm/head_model.h"

/* Area-weighted unit normals, outward; shape and normal are [model->n_vertices]. */
void iso_head_normals(const struct iso_head_model *model, const struct iso_vec3 *shape_mm,
                      struct iso_vec3 *normal);

#endif
