#include "isotherm/signature.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* Whether v comes before w when both are sorted by value, then by number. */
static bool below(const double *value, int32_t v, int32_t w)
{
    return value[v] < value[w] || (value[v] == value[w] && v < w);
}

/* Counts the neighbours of w, except v, that lie above and below v. */
static void compare_ring(const struct iso_shape *shape, const double *value, int32_t v, int32_t w,
                         int32_t *above_v, int32_t *below_v)
{
    for (int32_t at = shape->neighbour_start[w]; at < shape->neighbour_start[w + 1]; at++) {
        const int32_t u = shape->neighbour[at];
        if (u != v) {
            *(below(value, v, u) ? above_v : below_v) += 1;
        }
    }
}

/* Whether v is the highest or the lowest of its two rings. */
static bool is_extremum(const struct iso_shape *shape, const double *value, int32_t v)
{
    int32_t above_v = 0, below_v = 0;
    compare_ring(shape, value, v, v, &above_v, &below_v);
    for (int32_t at = shape->neighbour_start[v]; at < shape->neighbour_start[v + 1]; at++) {
        if (above_v > 0 && below_v > 0) {
            return false;
        }
        compare_ring(shape, value, v, shape->neighbour[at], &above_v, &below_v);
    }
    return (above_v == 0) != (below_v == 0);
}

/* By falling |value|. */
static void sort_points(const double *value, struct iso_critical_points *points)
{
    for (int32_t i = 1; i < points->n; i++) {
        int32_t v = points->vertex[i], at = i;
        for (; at > 0 && fabs(value[points->vertex[at - 1]]) < fabs(value[v]); at--) {
            points->vertex[at] = points->vertex[at - 1];
        }
        points->vertex[at] = v;
    }
}

int iso_shape_extrema(const struct iso_shape *shape, const double *function,
                      struct iso_critical_points *out)
{
    int32_t n = 0, n_vertices = shape->mesh->n_vertices;
    uint8_t *extremum = calloc((size_t)n_vertices, 1);
    if (!extremum) {
        return -ENOMEM;
    }
    for (int32_t v = 0; v < n_vertices; v++) {
        extremum[v] = !shape->near_boundary[v] && is_extremum(shape, function, v);
        n += extremum[v];
    }
    struct iso_critical_points points = {0, calloc((size_t)n + 1, sizeof *points.vertex)};
    for (int32_t v = 0; points.vertex && v < n_vertices; v++) {
        if (extremum[v]) {
            points.vertex[points.n++] = v;
        }
    }
    free(extremum);
    if (!points.vertex) {
        return -ENOMEM;
    }
    sort_points(function, &points);
    *out = points;
    return 0;
}

int iso_shape_critical_points(const struct iso_shape *shape, struct iso_critical_points *out)
{
    const double *phi = &shape->pairs->phi[shape->pairs->n];
    const int error = iso_shape_extrema(shape, phi, out);
    if (error || out->n > 0) {
        return error;
    }
    out->n = 1; /* there is room for one (iso_shape_extrema) */
    for (int32_t v = 1; v < shape->mesh->n_vertices; v++) {
        out->vertex[0] = fabs(phi[v]) > fabs(phi[out->vertex[0]]) ? v : out->vertex[0];
    }
    return 0;
}

void iso_critical_points_done(struct iso_critical_points *points)
{
    free(points->vertex);
    *points = (struct iso_critical_points){0};
}
