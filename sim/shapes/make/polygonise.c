#include "sim/shapes/make/polygonise.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A corner of a cube is a number of three bits, x the lowest. An edge of a tetrahedron runs from a
 * node to the one that is `corner` further on: seven kinds, 1..7, each belonging to its lower node.
 */
enum { EDGE_KINDS = 7 };

/* The six paths from corner 0 to corner 7 along the axes (Kuhn 1960). Even permutations of the
 * axes are right-handed; odd ones are written with two corners swapped. */
static const int tetrahedra[6][4] = {
    {0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 3, 2, 7}, {0, 6, 4, 7}, {0, 5, 1, 7},
};

struct march {
    const struct sim_field_grid *grid;
    double level;
    /* [2][nodes of a sheet][EDGE_KINDS]: index + 1, 0: no vertex yet. Edges of a cell belong to
     * nodes of its own sheet and of the next one, so that two sheets are kept: even and odd ones.
     */
    int32_t *vertex_of_edge;
    struct iso_mesh *mesh;
};

static size_t node_index(const struct sim_field_grid *grid, int i, int j, int k)
{
    return ((size_t)k * (size_t)grid->ny + (size_t)j) * (size_t)grid->nx + (size_t)i;
}

static size_t corner_node(const struct sim_field_grid *grid, size_t node, int corner)
{
    const size_t row = (size_t)grid->nx, sheet = row * (size_t)grid->ny;
    return node + (corner & 1 ? 1 : 0) + (corner & 2 ? row : 0) + (corner & 4 ? sheet : 0);
}

static struct iso_vec3 node_place(const struct sim_field_grid *grid, size_t node)
{
    const size_t nx = (size_t)grid->nx, ny = (size_t)grid->ny;
    struct iso_vec3 step = iso_vec3((double)(node % nx), (double)(node / nx % ny),
                                    (double)(node / nx / ny));
    return iso_madd(grid->origin_mm, grid->pitch_mm, step);
}

static int32_t *edges_of(const struct march *m, size_t node)
{
    const size_t sheet = (size_t)m->grid->nx * (size_t)m->grid->ny;
    const size_t place = node / sheet % 2 * sheet + node % sheet;
    return &m->vertex_of_edge[place * EDGE_KINDS];
}

/* The vertex on the edge between two corners of the cube at `node`, or -ENOMEM. */
static int32_t edge_vertex(struct march *m, size_t node, int a, int b)
{
    const int low = a < b ? a : b,
              high = a < b ? b : a; /* in a tetrahedron, high has all bits of low */
    const size_t from = corner_node(m->grid, node, low), to = corner_node(m->grid, node, high);
    int32_t *known = &edges_of(m, from)[high - low - 1];
    if (*known == 0) {
        if (iso_mesh_reserve(m->mesh, m->mesh->n_vertices + 1, 0)) {
            return -ENOMEM;
        }
        const double f = m->grid->value[from], t = m->grid->value[to];
        double share = (m->level - f) / (t - f);
        share = fmin(fmax(share, 0.1), 0.9);
        struct iso_vec3 p = node_place(m->grid, from), q = node_place(m->grid, to);
        m->mesh->vertices_mm[m->mesh->n_vertices] = iso_madd(p, share, iso_sub(q, p));
        *known = ++m->mesh->n_vertices;
    }
    return *known - 1;
}

static int add_triangle(struct march *m, int32_t a, int32_t b, int32_t c)
{
    if (a < 0 || b < 0 || c < 0 || iso_mesh_reserve(m->mesh, 0, m->mesh->n_triangles + 1)) {
        return -ENOMEM;
    }
    int32_t *t = m->mesh->triangles[m->mesh->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return 0;
}

/* Adds the triangle that separates corner p from the other three, q, whose order makes
 * (p, q[0], q[1], q[2]) right-handed. `inside`: p is inside. */
static int cut_corner(struct march *m, size_t node, int p, const int q[3], bool inside)
{
    const int32_t a = edge_vertex(m, node, p, q[0]), b = edge_vertex(m, node, p, q[1]);
    const int32_t c = edge_vertex(m, node, p, q[2]);
    return inside ? add_triangle(m, a, b, c) : add_triangle(m, a, c, b);
}

/* Adds the two triangles that separate the corners p, which are inside, from the corners q, which
 * are outside. (p[0], p[1], q[0], q[1]) is right-handed. */
static int cut_between(struct march *m, size_t node, const int p[2], const int q[2])
{
    const int32_t a = edge_vertex(m, node, p[0], q[0]), b = edge_vertex(m, node, p[1], q[0]);
    const int32_t c = edge_vertex(m, node, p[1], q[1]), d = edge_vertex(m, node, p[0], q[1]);
    const int error = add_triangle(m, a, c, b);
    if (error) {
        return error;
    }
    return add_triangle(m, a, d, c);
}

static int cut_tetrahedron(struct march *m, size_t node, const int corner[4])
{
    /* Even permutations that bring each corner, or each pair, to the front. */
    static const int single[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
    static const int pairs[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                    {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
    bool inside[4];
    int n_inside = 0;
    for (int i = 0; i < 4; i++) {
        inside[i] = m->grid->value[corner_node(m->grid, node, corner[i])] > m->level;
        n_inside += inside[i];
    }
    if (n_inside == 2) {
        for (int i = 0; i < 6; i++) {
            const int *o = pairs[i];
            if (inside[o[0]] && inside[o[1]]) {
                return cut_between(m, node, (int[2]){corner[o[0]], corner[o[1]]},
                                   (int[2]){corner[o[2]], corner[o[3]]});
            }
        }
    }
    for (int i = 0; i < 4 && (n_inside == 1 || n_inside == 3); i++) {
        if (inside[i] == (n_inside == 1)) {
            const int *o = single[i];
            return cut_corner(m, node, corner[o[0]],
                              (int[3]){corner[o[1]], corner[o[2]], corner[o[3]]}, inside[i]);
        }
    }
    return 0;
}

/* Handles the six tetrahedra of a cell, unless the whole cell is inside or outside. */
static int cut_cell(struct march *m, size_t node)
{
    int n_inside = 0, error = 0;
    for (int c = 0; c < 8; c++) {
        n_inside += m->grid->value[corner_node(m->grid, node, c)] > m->level;
    }
    for (int t = 0; t < 6 && n_inside > 0 && n_inside < 8 && !error; t++) {
        error = cut_tetrahedron(m, node, tetrahedra[t]);
    }
    return error;
}

static int march(struct march *m)
{
    const struct sim_field_grid *grid = m->grid;
    const size_t sheet = (size_t)grid->nx * (size_t)grid->ny;
    int error = 0;
    for (int k = 0; k + 1 < grid->nz; k++) {
        memset(edges_of(m, ((size_t)k + 1) * sheet), 0,
               sheet * EDGE_KINDS * sizeof *m->vertex_of_edge);
        for (int j = 0; j + 1 < grid->ny; j++) {
            for (int i = 0; i + 1 < grid->nx && !error; i++) {
                error = cut_cell(m, node_index(grid, i, j, k));
            }
        }
    }
    if (error) {
        return error;
    }
    return m->mesh->n_triangles > 0 ? 0 : -EINVAL;
}

int sim_polygonise(const struct sim_field_grid *grid, double level, struct iso_mesh **out)
{
    if (grid->nx < 2 || grid->ny < 2 || grid->nz < 2) {
        return -EINVAL;
    }
    const size_t sheets = 2 * (size_t)grid->nx * (size_t)grid->ny;
    struct march m = {.grid = grid, .level = level};
    m.vertex_of_edge = calloc(sheets, EDGE_KINDS * sizeof *m.vertex_of_edge);
    int error = m.vertex_of_edge ? iso_mesh_new(1024, 2048, &m.mesh) : -ENOMEM;
    if (!error) {
        error = march(&m);
    }
    free(m.vertex_of_edge);
    if (error) {
        iso_mesh_free(m.mesh);
        return error;
    }
    *out = m.mesh;
    return 0;
}
