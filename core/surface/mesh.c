#include "isotherm/mesh.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault.h"

int iso_mesh_new(int32_t vertex_capacity, int32_t triangle_capacity, struct iso_mesh **out)
{
    if (vertex_capacity < 1 || triangle_capacity < 1) {
        return -EINVAL;
    }
    struct iso_mesh *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    m->vertex_capacity = vertex_capacity;
    m->triangle_capacity = triangle_capacity;
    m->vertices_mm = calloc((size_t)vertex_capacity, sizeof *m->vertices_mm);
    m->triangles = calloc((size_t)triangle_capacity, sizeof *m->triangles);
    if (!m->vertices_mm || !m->triangles) {
        iso_mesh_free(m);
        return -ENOMEM;
    }
    *out = m;
    return 0;
}

void iso_mesh_free(struct iso_mesh *mesh)
{
    if (mesh) {
        free(mesh->vertices_mm);
        free(mesh->triangles);
        free(mesh);
    }
}

static const char *triangle_fault(const struct iso_mesh *mesh, int32_t t)
{
    const int32_t *v = mesh->triangles[t];
    for (int k = 0; k < 3; k++) {
        if (v[k] < 0 || v[k] >= mesh->n_vertices) {
            return "triangle with a vertex that does not exist";
        }
    }
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        return "triangle with the same vertex twice";
    }
    return NULL;
}

static const char *mesh_fault(const struct iso_mesh *mesh)
{
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        const struct iso_vec3 p = mesh->vertices_mm[i];
        if (!isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z)) {
            return "vertex that is not finite";
        }
    }
    const char *fault = NULL;
    for (int32_t t = 0; t < mesh->n_triangles && !fault; t++) {
        fault = triangle_fault(mesh, t);
    }
    return fault;
}

static int reserve_array(void **array, size_t element, int32_t wanted, int32_t *capacity)
{
    if (wanted <= *capacity) {
        return 0;
    }
    const int32_t doubled = *capacity <= INT32_MAX / 2 ? 2 * *capacity : INT32_MAX;
    const int32_t room = doubled > wanted ? doubled : wanted;
    void *moved = realloc(*array, (size_t)room * element);
    if (!moved) {
        return -ENOMEM;
    }
    *array = moved;
    *capacity = room;
    return 0;
}

int iso_mesh_reserve(struct iso_mesh *mesh, int32_t n_vertices, int32_t n_triangles)
{
    void *vertices = mesh->vertices_mm, *triangles = mesh->triangles;
    int error = reserve_array(&vertices, sizeof *mesh->vertices_mm, n_vertices,
                              &mesh->vertex_capacity);
    mesh->vertices_mm = vertices;
    if (!error) {
        error = reserve_array(&triangles, sizeof *mesh->triangles, n_triangles,
                              &mesh->triangle_capacity);
        mesh->triangles = triangles;
    }
    return error;
}

int iso_mesh_check(const struct iso_mesh *mesh, struct iso_fault *fault)
{
    const char *text = mesh_fault(mesh);
    return text ? iso_fault_set(fault, -EINVAL, "%s", text) : 0;
}

struct iso_vec3 iso_mesh_point_at(const struct iso_mesh *mesh, struct iso_surface_point point)
{
    struct iso_vec3 p = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        p = iso_madd(p, point.weight[k], mesh->vertices_mm[mesh->triangles[point.triangle][k]]);
    }
    return p;
}

double iso_mesh_triangle_area(const struct iso_mesh *mesh, int32_t triangle)
{
    const int32_t *v = mesh->triangles[triangle];
    const struct iso_vec3 a = mesh->vertices_mm[v[0]];
    return 0.5 * iso_norm(iso_cross(iso_sub(mesh->vertices_mm[v[1]], a),
                                    iso_sub(mesh->vertices_mm[v[2]], a)));
}

double iso_mesh_area(const struct iso_mesh *mesh)
{
    double area = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        area += iso_mesh_triangle_area(mesh, t);
    }
    return area;
}

/* One side of a triangle: its ends in rising order, and where it belongs. */
struct side {
    int32_t low, high;
    int32_t triangle;
    int32_t corner; /* the opposite one */
};

static int compare_sides(const void *a, const void *b)
{
    const struct side *s = a, *t = b;
    if (s->low != t->low) {
        return s->low < t->low ? -1 : 1;
    }
    if (s->high != t->high) {
        return s->high < t->high ? -1 : 1;
    }
    return (s->triangle > t->triangle) - (s->triangle < t->triangle);
}

int iso_mesh_adjacency(const struct iso_mesh *mesh, int32_t (*adjacent)[3])
{
    const size_t n = 3 * (size_t)mesh->n_triangles;
    struct side *sides = malloc((n + 1) * sizeof *sides);
    if (!sides) {
        return -ENOMEM;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int32_t k = 0; k < 3; k++) {
            int32_t p = mesh->triangles[t][(k + 1) % 3], q = mesh->triangles[t][(k + 2) % 3];
            sides[3 * t + k] = (struct side){p < q ? p : q, p < q ? q : p, t, k};
            adjacent[t][k] = -1;
        }
    }
    qsort(sides, n, sizeof *sides, compare_sides);
    for (size_t i = 0; i + 1 < n; i++) {
        struct side *s = &sides[i], *t = &sides[i + 1];
        if (s->low == t->low && s->high == t->high) {
            adjacent[s->triangle][s->corner] = t->triangle;
            adjacent[t->triangle][t->corner] = s->triangle;
            /* Further triangles at this edge count as boundary. */
            while (i + 2 < n && sides[i + 2].low == s->low && sides[i + 2].high == s->high) {
                i++;
            }
            i++;
        }
    }
    free(sides);
    return 0;
}

/* A piece that flood fill found; pieces are renumbered by area. */
struct piece {
    int32_t label;
    double area;
};

static int compare_pieces(const void *a, const void *b)
{
    const struct piece *p = a, *q = b;
    if (p->area != q->area) {
        return p->area > q->area ? -1 : 1;
    }
    return (p->label > q->label) - (p->label < q->label);
}

/* Labels all triangles that are joined to a seed. Returns their area. */
static double flood_piece(const struct iso_mesh *mesh, const int32_t (*adjacent)[3], int32_t seed,
                          int32_t label, int32_t *component, int32_t *stack)
{
    int32_t top = 0;
    double area = 0.0;
    stack[top++] = seed;
    component[seed] = label;
    while (top > 0) {
        const int32_t t = stack[--top];
        area += iso_mesh_triangle_area(mesh, t);
        for (int k = 0; k < 3; k++) {
            const int32_t next = adjacent[t][k];
            if (next >= 0 && component[next] < 0) {
                component[next] = label;
                stack[top++] = next;
            }
        }
    }
    return area;
}

int32_t iso_mesh_components(const struct iso_mesh *mesh, const int32_t (*adjacent)[3],
                            int32_t *component)
{
    const size_t n = (size_t)mesh->n_triangles + 1;
    int32_t *stack = malloc(n * sizeof *stack), *rank = malloc(n * sizeof *rank), pieces = 0;
    struct piece *piece = malloc(n * sizeof *piece);
    if (!stack || !rank || !piece) {
        pieces = -ENOMEM;
        goto out;
    }
    memset(component, 0xff, (n - 1) * sizeof *component);
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        if (component[t] < 0) {
            const double area = flood_piece(mesh, adjacent, t, pieces, component, stack);
            piece[pieces] = (struct piece){pieces, area};
            pieces++;
        }
    }
    qsort(piece, (size_t)pieces, sizeof *piece, compare_pieces);
    for (int32_t i = 0; i < pieces; i++) {
        rank[piece[i].label] = i;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        component[t] = rank[component[t]];
    }
out:
    free(stack);
    free(rank);
    free(piece);
    return pieces;
}

void iso_mesh_boundary(const struct iso_mesh *mesh, const int32_t (*adjacent)[3],
                       uint8_t *on_boundary)
{
    memset(on_boundary, 0, (size_t)mesh->n_vertices);
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            if (adjacent[t][k] < 0) {
                on_boundary[mesh->triangles[t][(k + 1) % 3]] = 1;
                on_boundary[mesh->triangles[t][(k + 2) % 3]] = 1;
            }
        }
    }
}
