#include "sim/train/head/decimate.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "sim/train/head/quadric.h"

enum {
    FAN_MAX = 24, /* triangles around a vertex after a merge */
    NEIGHBOURS_MAX = 2 * SIM_DECIMATE_FAN_LIMIT,
    NONE = UINT32_MAX,
};

/* A normal may turn by 60 degrees in one merge. */
static const double turn_cos_min = 0.5;

/* 4 sqrt(3) area / sum of squared edges: 1 for an equilateral triangle, 0 for a line. */
static const double quality_min = 0.2;

/* Weight of a distance from the boundary, relative to a distance from the surface. */
static const double boundary_weight = 0.3;

/* Cost for each squared edge length. It limits the size of triangles where the surface is flat. */
static const double length_weight = 5e-4;

struct fan {
    uint32_t n;
    uint32_t *triangle; /* room for FAN_MAX, or for as many as the mesh began with */
};

struct merge {
    uint32_t into; /* NONE: no merge is allowed */
    double cost;
};

struct state {
    const struct iso_vec3 *p;
    uint32_t n_vertices;
    uint32_t (*triangles)[3];
    const struct sim_decimate_options *options;
    struct fan *fan; /* n = 0: merged away */
    struct sim_quadric *quadric;
    uint32_t *fan_triangles; /* the memory of all fans */
    struct merge *best;      /* of each vertex */
    uint32_t n_leaves;       /* a power of two, at least n_vertices */
    uint32_t *cheapest;      /* [2 n_leaves]: a heap of the vertices with the cheapest merges; the
                              * lowest one of equal ones is above the others */
};

struct neighbours {
    uint32_t n;
    uint32_t vertex[NEIGHBOURS_MAX];
};

static struct iso_vec3 normal_of(const struct iso_vec3 p[3])
{
    return iso_cross(iso_sub(p[1], p[0]), iso_sub(p[2], p[0]));
}

static double quality_of(const struct iso_vec3 p[3])
{
    struct iso_vec3 a = iso_sub(p[1], p[0]), b = iso_sub(p[2], p[1]), c = iso_sub(p[0], p[2]);
    const double sum = iso_dot(a, a) + iso_dot(b, b) + iso_dot(c, c);
    return sum > 0.0 ? 2.0 * sqrt(3.0) * iso_norm(iso_cross(a, b)) / sum : 0.0;
}

static void corners_of(const struct state *s, uint32_t t, struct iso_vec3 p[3])
{
    for (int k = 0; k < 3; k++) {
        p[k] = s->p[s->triangles[t][k]];
    }
}

static bool has_corner(const uint32_t *triangle, uint32_t v)
{
    return triangle[0] == v || triangle[1] == v || triangle[2] == v;
}

static bool set_contains(const struct neighbours *set, uint32_t v)
{
    for (uint32_t i = 0; i < set->n; i++) {
        if (set->vertex[i] == v) {
            return true;
        }
    }
    return false;
}

static void find_neighbours(const struct state *s, uint32_t v, struct neighbours *set)
{
    set->n = 0;
    for (uint32_t i = 0; i < s->fan[v].n; i++) {
        const uint32_t *t = s->triangles[s->fan[v].triangle[i]];
        for (int k = 0; k < 3; k++) {
            if (t[k] != v && !set_contains(set, t[k])) {
                set->vertex[set->n++] = t[k];
            }
        }
    }
}

static uint32_t shared_triangles(const struct state *s, uint32_t v, uint32_t u)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->fan[v].n; i++) {
        n += has_corner(s->triangles[s->fan[v].triangle[i]], u);
    }
    return n;
}

/* Whether the surface stays a manifold: v is an inner vertex or moves along the boundary, and the
 * two vertices have no common neighbours except those across their edge (the link condition, Dey
 * et al. 1999). The merged vertex must not have more than FAN_MAX triangles. */
static bool topology_allows(const struct state *s, uint32_t v, uint32_t u,
                            const struct neighbours *around_v)
{
    const uint32_t n_shared = shared_triangles(s, v, u);
    const bool inner = around_v->n == s->fan[v].n, border = around_v->n == s->fan[v].n + 1;
    if (!(inner && n_shared == 2) && !(border && n_shared == 1)) {
        return false;
    }
    struct neighbours around_u;
    find_neighbours(s, u, &around_u);
    uint32_t n_common = 0;
    for (uint32_t i = 0; i < around_v->n; i++) {
        n_common += set_contains(&around_u, around_v->vertex[i]);
    }
    return n_common == n_shared && s->fan[v].n + s->fan[u].n - 2 * n_shared <= FAN_MAX;
}

/* Whether no remaining triangle of v flips, becomes a sliver, or becomes a worse sliver. */
static bool shape_allows(const struct state *s, uint32_t v, uint32_t u)
{
    for (uint32_t i = 0; i < s->fan[v].n; i++) {
        const uint32_t t = s->fan[v].triangle[i];
        if (has_corner(s->triangles[t], u)) {
            continue;
        }
        struct iso_vec3 before[3], after[3];
        corners_of(s, t, before);
        for (int k = 0; k < 3; k++) {
            after[k] = s->triangles[t][k] == v ? s->p[u] : before[k];
        }
        struct iso_vec3 n0 = normal_of(before), n1 = normal_of(after);
        const double quality = quality_of(after);
        if (iso_dot(n0, n1) < turn_cos_min * iso_norm(n0) * iso_norm(n1) ||
            (quality < quality_min && quality < quality_of(before))) {
            return false;
        }
    }
    return true;
}

static double cost_of(const struct state *s, uint32_t v, uint32_t u)
{
    struct sim_quadric q = s->quadric[v];
    sim_quadric_add(&q, &s->quadric[u]);
    struct iso_vec3 edge = iso_sub(s->p[u], s->p[v]);
    const double importance = s->options->importance ? s->options->importance[v] : 1.0;
    return importance * (fmax(sim_quadric_at(&q, s->p[u]), 0.0) +
                         length_weight * s->quadric[v].area_mm2 * iso_dot(edge, edge));
}

/* The costs of the vertices in the subtree changed: the cheaper child comes up. */
static void raise_cheapest(struct state *s, uint32_t v)
{
    for (uint32_t at = (s->n_leaves + v) / 2; at > 0; at /= 2) {
        const uint32_t left = s->cheapest[2 * at], right = s->cheapest[2 * at + 1];
        const bool take_right = left == NONE ||
                                (right != NONE && s->best[right].cost < s->best[left].cost);
        s->cheapest[at] = take_right ? right : left;
    }
}

static void find_best(struct state *s, uint32_t v)
{
    struct merge best = {NONE, INFINITY};
    if (s->fan[v].n > 0 && !(s->options->keep && s->options->keep[v])) {
        struct neighbours around;
        find_neighbours(s, v, &around);
        for (uint32_t i = 0; i < around.n; i++) {
            const uint32_t u = around.vertex[i];
            const double cost = cost_of(s, v, u);
            if (cost < best.cost && topology_allows(s, v, u, &around) && shape_allows(s, v, u)) {
                best = (struct merge){u, cost};
            }
        }
    }
    s->best[v] = best;
    raise_cheapest(s, v);
}

static void remove_from_fan(struct fan *fan, uint32_t t)
{
    for (uint32_t i = 0; i < fan->n; i++) {
        if (fan->triangle[i] == t) {
            fan->triangle[i] = fan->triangle[--fan->n];
            return;
        }
    }
}

static void merge_into(struct state *s, uint32_t v, uint32_t u)
{
    struct fan fan = s->fan[v];
    s->fan[v].n = 0;
    for (uint32_t i = 0; i < fan.n; i++) {
        const uint32_t t = fan.triangle[i];
        uint32_t *corner = s->triangles[t];
        if (has_corner(corner, u)) {
            for (int k = 0; k < 3; k++) {
                remove_from_fan(&s->fan[corner[k]], t);
                corner[k] = NONE;
            }
            continue;
        }
        for (int k = 0; k < 3; k++) {
            corner[k] = corner[k] == v ? u : corner[k];
        }
        s->fan[u].triangle[s->fan[u].n++] = t;
    }
    sim_quadric_add(&s->quadric[u], &s->quadric[v]);
}

/* A merge into u changes the allowed merges of u's neighbours and of their neighbours. */
static void update_around(struct state *s, uint32_t u)
{
    struct neighbours ring, second;
    find_neighbours(s, u, &ring);
    for (uint32_t i = 0; i < ring.n; i++) {
        find_neighbours(s, ring.vertex[i], &second);
        for (uint32_t j = 0; j < second.n; j++) {
            find_best(s, second.vertex[j]);
        }
        find_best(s, ring.vertex[i]);
    }
}

static void add_triangle_quadrics(struct state *s, uint32_t t)
{
    struct iso_vec3 p[3];
    corners_of(s, t, p);
    struct iso_vec3 normal = normal_of(p), unit = iso_unit(normal);
    const double area = 0.5 * iso_norm(normal);
    for (int k = 0; k < 3; k++) {
        const uint32_t v = s->triangles[t][k], w = s->triangles[t][(k + 1) % 3];
        sim_quadric_add_plane(&s->quadric[v], unit, p[k], area / 3.0);
        s->quadric[v].area_mm2 += area / 3.0;
        if (shared_triangles(s, v, w) == 1) {
            struct iso_vec3 edge = iso_sub(p[(k + 1) % 3], p[k]);
            struct iso_vec3 across = iso_unit(iso_cross(edge, unit));
            const double weight = boundary_weight * iso_dot(edge, edge);
            sim_quadric_add_plane(&s->quadric[v], across, p[k], weight);
            sim_quadric_add_plane(&s->quadric[w], across, p[k], weight);
        }
    }
}

/* Gives each fan as much room as it needs. */
static int make_fans(struct state *s, uint32_t n_triangles)
{
    const uint32_t most = s->options->fan_max ? s->options->fan_max : FAN_MAX;
    size_t all = 0;
    for (uint32_t t = 0; t < n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            const uint32_t v = s->triangles[t][k];
            if (v >= s->n_vertices || s->fan[v].n == most || most > SIM_DECIMATE_FAN_LIMIT) {
                return -EINVAL;
            }
            s->fan[v].n++;
        }
    }
    for (uint32_t v = 0; v < s->n_vertices; v++) {
        all += s->fan[v].n > FAN_MAX ? s->fan[v].n : FAN_MAX;
    }
    s->fan_triangles = calloc(all + 1, sizeof *s->fan_triangles);
    if (!s->fan_triangles) {
        return -ENOMEM;
    }
    uint32_t *room = s->fan_triangles;
    for (uint32_t v = 0; v < s->n_vertices; v++) {
        s->fan[v].triangle = room;
        room += s->fan[v].n > FAN_MAX ? s->fan[v].n : FAN_MAX;
        s->fan[v].n = 0;
    }
    for (uint32_t t = 0; t < n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            struct fan *fan = &s->fan[s->triangles[t][k]];
            fan->triangle[fan->n++] = t;
        }
    }
    return 0;
}

static int make_heap(struct state *s)
{
    for (s->n_leaves = 1; s->n_leaves < s->n_vertices;) {
        s->n_leaves *= 2;
    }
    s->cheapest = calloc(2 * (size_t)s->n_leaves, sizeof *s->cheapest);
    if (!s->cheapest) {
        return -ENOMEM;
    }
    for (uint32_t at = 0; at < 2 * s->n_leaves; at++) {
        const uint32_t leaf = at - s->n_leaves;
        s->cheapest[at] = at >= s->n_leaves && leaf < s->n_vertices ? leaf : NONE;
    }
    return 0;
}

static int set_up(struct state *s, uint32_t n_triangles)
{
    int error = make_fans(s, n_triangles);
    if (!error) {
        error = make_heap(s);
    }
    if (error) {
        return error;
    }
    for (uint32_t t = 0; t < n_triangles; t++) {
        add_triangle_quadrics(s, t);
    }
    for (uint32_t v = 0; v < s->n_vertices; v++) {
        find_best(s, v);
    }
    return 0;
}

static void run_collapses(struct state *s)
{
    uint32_t n_left = 0;
    for (uint32_t v = 0; v < s->n_vertices; v++) {
        n_left += s->fan[v].n > 0;
    }
    for (; n_left > s->options->n_target; n_left--) {
        const uint32_t v = s->cheapest[1], u = s->best[v].into;
        if (u == NONE) {
            return;
        }
        merge_into(s, v, u);
        find_best(s, v);
        update_around(s, u);
    }
}

int sim_decimate(const struct iso_vec3 *vertices_mm, uint32_t n_vertices,
                 const struct sim_decimate_options *options, uint32_t (*triangles)[3],
                 uint32_t *n_triangles)
{
    struct state s = {.p = vertices_mm,
                      .n_vertices = n_vertices,
                      .triangles = triangles,
                      .options = options,
                      .fan = calloc(n_vertices, sizeof *s.fan),
                      .quadric = calloc(n_vertices, sizeof *s.quadric),
                      .best = calloc(n_vertices, sizeof *s.best)};
    const int error = s.fan && s.quadric && s.best ? set_up(&s, *n_triangles) : -ENOMEM;
    if (!error) {
        run_collapses(&s);
        uint32_t n = 0;
        for (uint32_t t = 0; t < *n_triangles; t++) {
            if (triangles[t][0] != NONE) {
                memmove(triangles[n++], triangles[t], sizeof triangles[t]);
            }
        }
        *n_triangles = n;
    }
    free(s.cheapest);
    free(s.best);
    free(s.quadric);
    free(s.fan_triangles);
    free(s.fan);
    return error;
}
