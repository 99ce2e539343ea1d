#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/world/prop/solid.h"

/* An edge with the direction in which a triangle traverses it. */
struct edge {
    uint32_t low, high;
    bool upward; /* from the lower vertex number to the higher */
};

static int compare_edges(const void *a, const void *b)
{
    const struct edge *p = a, *q = b;
    const int order = (p->low > q->low) - (p->low < q->low);
    return order ? order : (p->high > q->high) - (p->high < q->high);
}

/* Moves the edges that belong to only one triangle to the front, and returns their number. */
static uint32_t keep_borders(struct edge *edges, size_t n)
{
    uint32_t kept = 0;
    qsort(edges, n, sizeof *edges, compare_edges);
    for (size_t i = 0; i < n;) {
        size_t end = i + 1;
        while (end < n && compare_edges(&edges[i], &edges[end]) == 0) {
            end++;
        }
        if (end == i + 1) {
            edges[kept++] = edges[i];
        }
        i = end;
    }
    return kept;
}

static struct edge *edges_of(const struct sim_solid *solid)
{
    struct edge *edges = malloc(3 * (size_t)solid->n_triangles * sizeof *edges);
    for (size_t i = 0; edges && i < 3 * (size_t)solid->n_triangles; i++) {
        const uint32_t a = solid->triangles[i / 3][i % 3], b = solid->triangles[i / 3][(i + 1) % 3];
        edges[i] = (struct edge){a < b ? a : b, a < b ? b : a, a < b};
    }
    return edges;
}

/* Writes the area-weighted normals of the vertices, not of unit length, into normals[n_vertices].
 */
static void sum_normals(const struct sim_solid *solid, struct iso_vec3 *normals)
{
    memset(normals, 0, solid->n_vertices * sizeof *normals);
    for (uint32_t t = 0; t < solid->n_triangles; t++) {
        const uint32_t *corner = solid->triangles[t];
        struct iso_vec3 a = solid->vertices_mm[corner[0]];
        struct iso_vec3 normal = iso_cross(iso_sub(solid->vertices_mm[corner[1]], a),
                                           iso_sub(solid->vertices_mm[corner[2]], a));
        for (int k = 0; k < 3; k++) {
            normals[corner[k]] = iso_add(normals[corner[k]], normal);
        }
    }
}

static void fill_thick(const struct sim_solid *thin, const struct edge *borders, uint32_t n_borders,
                       double shell_mm, struct sim_solid *thick)
{
    const uint32_t n = thin->n_vertices, m = thin->n_triangles;
    struct iso_vec3 *inner = thick->vertices_mm + n;
    sum_normals(thin, inner);
    for (uint32_t v = 0; v < n; v++) {
        thick->vertices_mm[v] = thin->vertices_mm[v];
        inner[v] = iso_madd(thin->vertices_mm[v], -shell_mm, iso_unit(inner[v]));
    }
    for (uint32_t t = 0; t < m; t++) {
        for (int k = 0; k < 3; k++) {
            thick->triangles[t][k] = thin->triangles[t][k];
            thick->triangles[m + t][k] = n + thin->triangles[t][2 - k];
        }
    }
    for (uint32_t b = 0; b < n_borders; b++) {
        const uint32_t from = borders[b].upward ? borders[b].low : borders[b].high;
        const uint32_t to = borders[b].upward ? borders[b].high : borders[b].low;
        const uint32_t wall[2][3] = {{to, from, n + from}, {to, n + from, n + to}};
        memcpy(thick->triangles + 2 * (size_t)(m + b), wall, sizeof wall);
    }
}

int sim_solid_thicken(struct sim_solid *solid, double shell_mm)
{
    struct edge *edges = edges_of(solid);
    if (!edges) {
        return -ENOMEM;
    }
    const uint32_t n_borders = keep_borders(edges, 3 * (size_t)solid->n_triangles);
    struct sim_solid *thick;
    const int error = sim_solid_new(2 * solid->n_vertices, 2 * (solid->n_triangles + n_borders),
                                    solid->material, &thick);
    if (error == 0) {
        fill_thick(solid, edges, n_borders, shell_mm, thick);
        struct sim_solid thin = *solid;
        *solid = *thick;
        *thick = thin;
        sim_solid_free(thick);
    }
    free(edges);
    return error;
}
