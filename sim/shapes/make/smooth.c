#include "sim/shapes/make/smooth.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const double shrink = 0.5, grow_back = -0.53;

struct rings {
    int32_t (*adjacent)[3];
    uint8_t *on_boundary;
    struct iso_vec3 *sum;
    double *weight;
};

/* Adds the neighbour `from` to the sums of vertex v. */
static void hear(const struct iso_mesh *mesh, struct rings *rings, int32_t v, int32_t from,
                 double weight)
{
    rings->sum[v] = iso_madd(rings->sum[v], weight, mesh->vertices_mm[from]);
    rings->weight[v] += weight;
}

/* Each triangle adds its edges once, so that an inner edge is added twice with half weight. A
 * vertex on the boundary uses only its neighbours along the boundary. */
static void hear_edges(const struct iso_mesh *mesh, struct rings *rings)
{
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            const int32_t a = mesh->triangles[t][(k + 1) % 3], b = mesh->triangles[t][(k + 2) % 3];
            const int border = rings->adjacent[t][k] < 0;
            const double weight = border ? 1.0 : 0.5;
            if (border || !rings->on_boundary[a]) {
                hear(mesh, rings, a, b, weight);
            }
            if (border || !rings->on_boundary[b]) {
                hear(mesh, rings, b, a, weight);
            }
        }
    }
}

static void step(struct iso_mesh *mesh, struct rings *rings, double factor)
{
    const size_t n = (size_t)mesh->n_vertices;
    memset(rings->sum, 0, n * sizeof *rings->sum);
    memset(rings->weight, 0, n * sizeof *rings->weight);
    hear_edges(mesh, rings);
    for (size_t v = 0; v < n; v++) {
        if (rings->weight[v] > 0.0) {
            struct iso_vec3 *p = &mesh->vertices_mm[v];
            struct iso_vec3 mean = iso_scale(1.0 / rings->weight[v], rings->sum[v]);
            *p = iso_madd(*p, factor, iso_sub(mean, *p));
        }
    }
}

int sim_smooth(struct iso_mesh *mesh, int steps)
{
    const size_t n = (size_t)mesh->n_vertices;
    struct rings rings = {
        .adjacent = calloc((size_t)mesh->n_triangles, sizeof *rings.adjacent),
        .on_boundary = calloc(n, 1),
        .sum = calloc(n, sizeof *rings.sum),
        .weight = calloc(n, sizeof *rings.weight),
    };
    const int error = rings.adjacent && rings.on_boundary && rings.sum && rings.weight
                          ? iso_mesh_adjacency(mesh, rings.adjacent)
                          : -ENOMEM;
    if (!error) {
        iso_mesh_boundary(mesh, (const int32_t(*)[3])rings.adjacent, rings.on_boundary);
    }
    for (int i = 0; i < steps && !error; i++) {
        step(mesh, &rings, shrink);
        step(mesh, &rings, grow_back);
    }
    free(rings.adjacent);
    free(rings.on_boundary);
    free(rings.sum);
    free(rings.weight);
    return error;
}
