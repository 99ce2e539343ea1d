#include "sim/shapes/make/thin.h"

#include <errno.h>
#include <stdlib.h>

#include "sim/train/head/decimate.h"

/* Removes vertices without a triangle. */
static int drop_unused(struct iso_coloured_mesh *coloured)
{
    struct iso_mesh *mesh = coloured->mesh;
    int32_t *renamed = calloc((size_t)mesh->n_vertices, sizeof *renamed), n = 0;
    if (!renamed) {
        return -ENOMEM;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            renamed[mesh->triangles[t][k]] = 1;
        }
    }
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        if (renamed[v]) {
            mesh->vertices_mm[n] = mesh->vertices_mm[v];
            if (coloured->colour) {
                coloured->colour[n] = coloured->colour[v];
            }
            renamed[v] = n++;
        }
    }
    mesh->n_vertices = n;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[t][k] = renamed[mesh->triangles[t][k]];
        }
    }
    free(renamed);
    return 0;
}

int sim_thin(struct iso_coloured_mesh *coloured, int32_t n_vertices)
{
    struct iso_mesh *mesh = coloured->mesh;
    struct sim_decimate_options options = {.n_target = (uint32_t)n_vertices,
                                           .fan_max = SIM_DECIMATE_FAN_LIMIT};
    uint32_t n_triangles = (uint32_t)mesh->n_triangles;
    /* Indices are never negative, so that their unsigned values are equal. */
    const int error = sim_decimate(mesh->vertices_mm, (uint32_t)mesh->n_vertices, &options,
                                   (uint32_t(*)[3])(void *)mesh->triangles, &n_triangles);
    if (error) {
        return error;
    }
    mesh->n_triangles = (int32_t)n_triangles;
    return drop_unused(coloured);
}
