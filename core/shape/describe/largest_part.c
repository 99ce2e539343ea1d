#include "core/shape/describe/largest_part.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* Area over the square of the longest edge, below which a triangle is a line. */
static const double least_roundness = 1e-8;

bool iso_triangle_has_area(const struct iso_mesh *mesh, int32_t t)
{
    const int32_t *v = mesh->triangles[t];
    double longest = 0.0;
    for (int k = 0; k < 3; k++) {
        const struct iso_vec3 edge = iso_sub(mesh->vertices_mm[v[(k + 1) % 3]],
                                             mesh->vertices_mm[v[k]]);
        longest = fmax(longest, iso_dot(edge, edge));
    }
    return longest > 0.0 && iso_mesh_triangle_area(mesh, t) >= least_roundness * longest;
}

int32_t iso_part_root(int32_t *parent, int32_t v)
{
    while (parent[v] != v) {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    return v;
}

int32_t iso_largest_part(const struct iso_mesh *mesh, int32_t *parent, double *area)
{
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        parent[v] = v;
        area[v] = 0.0;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        if (iso_triangle_has_area(mesh, t)) {
            const int32_t root = iso_part_root(parent, v[0]);
            parent[iso_part_root(parent, v[1])] = root;
            parent[iso_part_root(parent, v[2])] = root;
        }
    }
    int32_t best = -1;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        if (iso_triangle_has_area(mesh, t)) {
            const int32_t root = iso_part_root(parent, mesh->triangles[t][0]);
            area[root] += iso_mesh_triangle_area(mesh, t);
            best = best < 0 || area[root] > area[best] ? root : best;
        }
    }
    return best;
}

static void count_parts(const struct iso_mesh *mesh, int32_t *parent, const double *area,
                        int32_t best, struct iso_part_survey *survey)
{
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const int32_t root = iso_part_root(parent, v);
        survey->n_parts += root == v && area[v] > 0.0;
        survey->n_vertices += root == best;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        if (!iso_triangle_has_area(mesh, t)) {
            survey->flat_triangles++;
        } else if (iso_part_root(parent, mesh->triangles[t][0]) == best) {
            survey->n_triangles++;
            survey->area += iso_mesh_triangle_area(mesh, t);
        } else {
            survey->area_left_out += iso_mesh_triangle_area(mesh, t);
        }
    }
    survey->vertices_left_out = mesh->n_vertices - survey->n_vertices;
}

int iso_part_survey(const struct iso_mesh *mesh, struct iso_part_survey *out)
{
    const size_t n = (size_t)mesh->n_vertices + 1;
    int32_t *parent = calloc(n, sizeof *parent);
    double *area = calloc(n, sizeof *area);
    struct iso_part_survey survey = {0};
    const bool room = parent && area;
    if (room) {
        const int32_t best = iso_largest_part(mesh, parent, area);
        count_parts(mesh, parent, area, best, &survey);
        *out = survey;
    }
    free(parent);
    free(area);
    return room ? 0 : -ENOMEM;
}
