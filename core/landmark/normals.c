#include "core/landmark/normals.h"

#include <string.h>

void iso_triangle_normals(const uint32_t (*triangles)[3], uint32_t n_triangles,
                          const struct iso_vec3 *shape_mm, struct iso_vec3 *sum)
{
    for (uint32_t t = 0; t < n_triangles; t++) {
        const uint32_t *v = triangles[t];
        const struct iso_vec3 a = shape_mm[v[0]];
        const struct iso_vec3 area = iso_cross(iso_sub(shape_mm[v[1]], a),
                                               iso_sub(shape_mm[v[2]], a));
        for (int k = 0; k < 3; k++) {
            sum[v[k]] = iso_add(sum[v[k]], area);
        }
    }
}

void iso_head_normals(const struct iso_head_model *model, const struct iso_vec3 *shape_mm,
                      struct iso_vec3 *normal)
{
    memset(normal, 0, model->n_vertices * sizeof *normal);
    iso_triangle_normals((const uint32_t(*)[3])model->triangles, model->n_triangles, shape_mm,
                         normal);
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        normal[i] = iso_unit(normal[i]);
    }
}
