#include "sim/train/head/opening.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

enum { NONE = UINT32_MAX, RIMS_MAX = 16 };

/* Lids closer than this need no vertices on the eyeball between them. */
static const double lid_gap_mm = 4.0;

/* A path over vertices of the surface. */
struct chain {
    uint32_t n;
    uint32_t *vertex;
};

int sim_surface_add_vertex(struct sim_surface_builder *builder, const struct sim_ict *ict,
                           struct sim_head_vertex vertex)
{
    struct sim_head_surface *s = builder->surface;
    if (s->n_vertices == builder->vertex_capacity) {
        return -ENOSPC;
    }
    const float *nose = ict->mean_mm + 3 * (size_t)ict->landmarks[30];
    const float *a = ict->mean_mm + 3 * (size_t)vertex.source[0];
    const float *b = ict->mean_mm + 3 * (size_t)vertex.source[1];
    double middle[3];
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * ((double)a[k] + (double)b[k]) - (double)nose[k];
    }
    s->vertices[s->n_vertices] = vertex;
    s->mean_mm[s->n_vertices] = iso_add(iso_vec3(middle[0], middle[1], middle[2]),
                                        vertex.offset_mm);
    s->n_vertices++;
    return 0;
}

int sim_surface_add_triangle(struct sim_surface_builder *builder, uint32_t a, uint32_t b,
                             uint32_t c)
{
    struct sim_head_surface *s = builder->surface;
    if (s->n_triangles == builder->triangle_capacity) {
        return -ENOSPC;
    }
    uint32_t *t = s->triangles[s->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return 0;
}

static int compare_u64(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static uint64_t edge_key(uint32_t from, uint32_t to)
{
    return (uint64_t)from << 32 | to;
}

/* Sets next[v]: the vertex after v along the boundary, with the surface on the left; NONE for
 * inner vertices. */
static int find_boundary(const struct sim_head_surface *surface, uint32_t *next)
{
    const size_t n = 3 * (size_t)surface->n_triangles;
    uint64_t *edges = malloc(n * sizeof *edges);
    if (!edges) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        const uint32_t *t = surface->triangles[i / 3];
        edges[i] = edge_key(t[i % 3], t[(i + 1) % 3]);
    }
    qsort(edges, n, sizeof *edges, compare_u64);
    for (uint32_t v = 0; v < surface->n_vertices; v++) {
        next[v] = NONE;
    }
    int error = 0;
    for (size_t i = 0; i < n && !error; i++) {
        const uint32_t from = (uint32_t)(edges[i] >> 32), to = (uint32_t)edges[i];
        uint64_t back = edge_key(to, from);
        if (bsearch(&back, edges, n, sizeof *edges, compare_u64)) {
            continue;
        }
        error = next[from] == NONE ? 0 : -EINVAL;
        next[from] = to;
    }
    free(edges);
    return error;
}

/* Walks along the rim of `start` and removes it from `next`. */
static int take_rim(const struct sim_head_surface *surface, uint32_t start, uint32_t *next,
                    struct chain *rim, double *length_mm)
{
    rim->n = 0;
    *length_mm = 0.0;
    for (uint32_t v = start;;) {
        const uint32_t w = next[v];
        if (w == NONE) {
            return -EINVAL;
        }
        rim->vertex[rim->n++] = v;
        *length_mm += iso_norm(iso_sub(surface->mean_mm[w], surface->mean_mm[v]));
        next[v] = NONE;
        if (w == start) {
            return 0;
        }
        v = w;
    }
}

/* Joins two chains that share both ends with a strip of triangles. `upper` lies above `lower`,
 * and both run towards +x. Of the two possible next triangles, the one with the shorter new edge
 * is taken. */
static int add_strip(struct sim_surface_builder *builder, const struct chain *upper,
                     const struct chain *lower)
{
    const struct iso_vec3 *p = builder->surface->mean_mm;
    const uint32_t *u = upper->vertex, *l = lower->vertex;
    uint32_t i = 0, j = 0;
    int error = 0;
    while (!error && (i + 1 < upper->n || j + 1 < lower->n)) {
        bool along_upper = j + 1 == lower->n;
        if (!along_upper && i + 1 < upper->n) {
            along_upper = iso_norm(iso_sub(p[u[i + 1]], p[l[j]])) <
                          iso_norm(iso_sub(p[u[i]], p[l[j + 1]]));
        }
        const uint32_t ahead = along_upper ? u[i + 1] : l[j + 1];
        if (u[i] != l[j] && ahead != u[i] && ahead != l[j]) {
            error = sim_surface_add_triangle(builder, u[i], l[j], ahead);
        }
        i += along_upper;
        j += !along_upper;
    }
    return error;
}

/* Finds the depth *z of the eyeballs' frontmost point at (x, y) of the face frame. Returns false
 * where there is none. */
static bool eyeball_z(const struct sim_ict *ict, double x, double y, double *z)
{
    const float *nose = ict->mean_mm + 3 * (size_t)ict->landmarks[30];
    bool found = false;
    for (uint32_t t = 0; t < ict->n_triangles; t++) {
        const uint32_t *corner = ict->triangles[t];
        if (corner[0] < SIM_ICT_EYEBALLS) {
            continue;
        }
        struct iso_vec3 p[3];
        for (int k = 0; k < 3; k++) {
            const float *v = ict->mean_mm + 3 * (size_t)corner[k];
            p[k] = iso_vec3((double)(v[0] - nose[0]), (double)(v[1] - nose[1]),
                            (double)(v[2] - nose[2]));
        }
        const double twice_area = (p[1].x - p[0].x) * (p[2].y - p[0].y) -
                                  (p[1].y - p[0].y) * (p[2].x - p[0].x);
        const double w1 = ((x - p[0].x) * (p[2].y - p[0].y) - (y - p[0].y) * (p[2].x - p[0].x)) /
                          twice_area;
        const double w2 = ((p[1].x - p[0].x) * (y - p[0].y) - (p[1].y - p[0].y) * (x - p[0].x)) /
                          twice_area;
        if (!(w1 >= 0.0 && w2 >= 0.0 &&
              w1 + w2 <= 1.0)) { /* not finite for a triangle seen from its edge */
            continue;
        }
        const double here = p[0].z + w1 * (p[1].z - p[0].z) + w2 * (p[2].z - p[0].z);
        *z = found ? fmax(*z, here) : here;
        found = true;
    }
    return found;
}

static uint32_t nearest_in_x(const struct sim_head_surface *surface, const struct chain *chain,
                             double x)
{
    uint32_t best = chain->vertex[0];
    for (uint32_t i = 1; i < chain->n; i++) {
        const uint32_t v = chain->vertex[i];
        if (fabs(surface->mean_mm[v].x - x) < fabs(surface->mean_mm[best].x - x)) {
            best = v;
        }
    }
    return best;
}

/* Makes a row of vertices between the lids from corner to corner. It leaves out vertices where the
 * lids are close together or where no eyeball is behind them (the mouth). */
static int add_middle_row(struct sim_surface_builder *builder, const struct sim_ict *ict,
                          const struct chain *upper, const struct chain *lower, struct chain *row)
{
    const struct sim_head_surface *s = builder->surface;
    row->n = 0;
    row->vertex[row->n++] = upper->vertex[0];
    for (uint32_t i = 1; i + 1 < upper->n; i++) {
        const uint32_t above = upper->vertex[i];
        const uint32_t below = nearest_in_x(s, lower, s->mean_mm[above].x);
        struct iso_vec3 gap = iso_sub(s->mean_mm[above], s->mean_mm[below]);
        struct iso_vec3 middle = iso_madd(s->mean_mm[below], 0.5, gap);
        double z;
        if (iso_norm(gap) < lid_gap_mm || !eyeball_z(ict, middle.x, middle.y, &z)) {
            continue;
        }
        struct sim_head_vertex vertex = {
            .source = {s->vertices[above].source[0], s->vertices[below].source[0]},
            .offset_mm = iso_vec3(0.0, 0.0, z - middle.z),
        };
        row->vertex[row->n++] = s->n_vertices;
        const int error = sim_surface_add_vertex(builder, ict, vertex);
        if (error) {
            return error;
        }
    }
    row->vertex[row->n++] = upper->vertex[upper->n - 1];
    return 0;
}

/* Splits a rim at its smallest and its largest x. The surface is on the left and the hole on the
 * right, so that the path from the smallest x over the top comes first. Both halves run towards
 * +x. */
static void split_rim(const struct sim_head_surface *surface, const struct chain *rim,
                      struct chain *upper, struct chain *lower)
{
    uint32_t from = 0, to = 0;
    for (uint32_t i = 1; i < rim->n; i++) {
        const double x = surface->mean_mm[rim->vertex[i]].x;
        from = x < surface->mean_mm[rim->vertex[from]].x ? i : from;
        to = x > surface->mean_mm[rim->vertex[to]].x ? i : to;
    }
    upper->n = (to + rim->n - from) % rim->n + 1;
    lower->n = (from + rim->n - to) % rim->n + 1;
    for (uint32_t i = 0; i < upper->n; i++) {
        upper->vertex[i] = rim->vertex[(from + i) % rim->n];
    }
    for (uint32_t i = 0; i < lower->n; i++) {
        lower->vertex[lower->n - 1 - i] = rim->vertex[(to + i) % rim->n];
    }
}

static int close_rim(struct sim_surface_builder *builder, const struct sim_ict *ict,
                     const struct chain *rim)
{
    const size_t room = (size_t)rim->n + 1;
    uint32_t *memory = calloc(3 * room, sizeof *memory);
    if (!memory) {
        return -ENOMEM;
    }
    struct chain upper = {0, memory}, lower = {0, memory + room}, row = {0, memory + 2 * room};
    split_rim(builder->surface, rim, &upper, &lower);
    int error = add_middle_row(builder, ict, &upper, &lower, &row);
    if (!error && row.n > 2) {
        error = add_strip(builder, &upper, &row);
        if (!error) {
            error = add_strip(builder, &row, &lower);
        }
    } else if (!error) {
        error = add_strip(builder, &upper, &lower);
    }
    free(memory);
    return error;
}

int sim_close_openings(struct sim_surface_builder *builder, const struct sim_ict *ict)
{
    struct sim_head_surface *s = builder->surface;
    uint32_t n = s->n_vertices, n_rims = 0, outer = 0;
    uint32_t *next = calloc(n, sizeof *next), *vertices = calloc(n, sizeof *vertices);
    struct chain rims[RIMS_MAX];
    double length_mm[RIMS_MAX];
    int error = next && vertices ? find_boundary(s, next) : -ENOMEM;
    uint32_t *free_part = vertices;
    for (uint32_t v = 0; !error && v < n; v++) {
        if (next[v] == NONE) {
            continue;
        }
        if (n_rims == RIMS_MAX) {
            error = -EINVAL;
            break;
        }
        rims[n_rims].vertex = free_part;
        error = take_rim(s, v, next, &rims[n_rims], &length_mm[n_rims]);
        free_part += rims[n_rims].n;
        outer = length_mm[n_rims] > length_mm[outer] ? n_rims : outer;
        n_rims++;
    }
    for (uint32_t i = 0; !error && i < n_rims; i++) {
        error = i == outer ? 0 : close_rim(builder, ict, &rims[i]);
    }
    free(vertices);
    free(next);
    return error;
}
