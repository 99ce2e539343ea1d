#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/surface/corners.h"

#include "isotherm/mesh_file.h"

struct keyed {
    struct iso_vec3 at;
    int32_t vertex;
};

static int compare_places(const void *a, const void *b)
{
    const struct keyed *p = a, *q = b;
    if (p->at.x != q->at.x) {
        return p->at.x < q->at.x ? -1 : 1;
    }
    if (p->at.y != q->at.y) {
        return p->at.y < q->at.y ? -1 : 1;
    }
    if (p->at.z != q->at.z) {
        return p->at.z < q->at.z ? -1 : 1;
    }
    return (p->vertex > q->vertex) - (p->vertex < q->vertex);
}

/* first[v]: the lowest vertex at the same place as v. */
static int find_first(const struct iso_mesh *mesh, int32_t *first)
{
    const size_t n = (size_t)mesh->n_vertices;
    struct keyed *order = calloc(n, sizeof *order);
    if (!order) {
        return -ENOMEM;
    }
    for (size_t v = 0; v < n; v++) {
        order[v] = (struct keyed){mesh->vertices_mm[v], (int32_t)v};
    }
    qsort(order, n, sizeof *order, compare_places);
    for (size_t i = 0; i < n; i++) {
        const bool same = i > 0 && order[i].at.x == order[i - 1].at.x &&
                          order[i].at.y == order[i - 1].at.y && order[i].at.z == order[i - 1].at.z;
        first[order[i].vertex] = same ? first[order[i - 1].vertex] : order[i].vertex;
    }
    free(order);
    return 0;
}

/* keep[t]: 1 for the first triangle with these corners, if they are at three different places. */
static int find_triangles(const struct iso_mesh *mesh, const int32_t *first, uint8_t *keep,
                          struct iso_mesh_mended *report)
{
    struct iso_corners *order = calloc((size_t)mesh->n_triangles + 1, sizeof *order);
    size_t n = 0;
    if (!order) {
        return -ENOMEM;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *at = mesh->triangles[t];
        const struct iso_corners c = iso_corners_of(
            (const int32_t[3]){first[at[0]], first[at[1]], first[at[2]]}, t);
        if (c.sorted[0] == c.sorted[1] || c.sorted[1] == c.sorted[2]) {
            report->collapsed++;
        } else {
            order[n++] = c;
        }
    }
    qsort(order, n, sizeof *order, iso_corners_compare);
    for (size_t i = 0; i < n; i++) {
        const bool same = i > 0 && iso_corners_are_same(&order[i], &order[i - 1]);
        keep[order[i].triangle] = !same;
        report->repeated += same;
    }
    free(order);
    return n > 0 || mesh->n_triangles == 0 ? 0 : -EBADMSG;
}

/* The first vertex at a place gets the mean colour of all vertices at this place. */
static void mix_colours(struct iso_colour *colour, const int32_t *first, int32_t n, int32_t *count)
{
    for (int32_t v = 0; v < n; v++) {
        count[v] = 1;
    }
    for (int32_t v = 0; v < n; v++) {
        const int32_t f = first[v];
        for (int k = 0; f != v && k < 3; k++) {
            float *mean = &colour[f].channel[k];
            *mean += (colour[v].channel[k] - *mean) / (float)(count[f] + 1);
        }
        count[f] += f != v;
    }
}

/* Marks the vertices of kept triangles, or of a cloud the first one at every place. */
static void mark_used(const struct iso_mesh *mesh, const int32_t *first, const uint8_t *keep,
                      int32_t *used)
{
    memset(used, 0, (size_t)mesh->n_vertices * sizeof *used);
    for (int32_t v = 0; v < mesh->n_vertices && mesh->n_triangles == 0; v++) {
        used[v] = first[v] == v;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3 && keep[t]; k++) {
            used[first[mesh->triangles[t][k]]] = 1;
        }
    }
}

/* Moves the kept vertices and triangles to the front; `renamed` is scratch. */
static void compact(struct iso_coloured_mesh *coloured, const int32_t *first, const uint8_t *keep,
                    int32_t *renamed, struct iso_mesh_mended *report)
{
    struct iso_mesh *mesh = coloured->mesh;
    int32_t n_triangles = 0, n_vertices = 0;
    if (coloured->colour) {
        mix_colours(coloured->colour, first, mesh->n_vertices, renamed);
    }
    mark_used(mesh, first, keep, renamed);
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        if (keep[t]) {
            int32_t *c = mesh->triangles[n_triangles++];
            for (int k = 0; k < 3; k++) {
                c[k] = first[mesh->triangles[t][k]];
            }
        }
    }
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        report->merged += first[v] != v;
        report->unused += first[v] == v && !renamed[v];
        if (renamed[v]) {
            mesh->vertices_mm[n_vertices] = mesh->vertices_mm[v];
            if (coloured->colour) {
                coloured->colour[n_vertices] = coloured->colour[v];
            }
            renamed[v] = n_vertices++;
        }
    }
    for (int32_t t = 0; t < n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[t][k] = renamed[mesh->triangles[t][k]];
        }
    }
    mesh->n_vertices = n_vertices;
    mesh->n_triangles = n_triangles;
}

int iso_mesh_mend(struct iso_coloured_mesh *coloured, struct iso_mesh_mended *report)
{
    struct iso_mesh *mesh = coloured->mesh;
    const size_t n = (size_t)mesh->n_vertices, n_triangles = (size_t)mesh->n_triangles;
    if (n == 0) {
        return -EBADMSG;
    }
    struct iso_mesh_mended mended = {0, 0, 0, 0};
    int32_t *first = calloc(n, sizeof *first), *renamed = calloc(n, sizeof *renamed);
    uint8_t *keep = calloc(n_triangles + 1, 1);
    int error = first && renamed && keep ? find_first(mesh, first) : -ENOMEM;
    if (!error) {
        error = find_triangles(mesh, first, keep, &mended);
    }
    if (!error) {
        compact(coloured, first, keep, renamed, &mended);
        if (report) {
            *report = mended;
        }
    }
    free(first);
    free(renamed);
    free(keep);
    return error;
}
