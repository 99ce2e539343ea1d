#include "isotherm/triangulate.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/surface/frame_cell.h"

/* The triangles of one cell (cell.h): the index of the first, and the corners of each. With a count
 * of 0 the cell is empty. */
struct cell {
    int32_t first;
    uint8_t count;
    uint8_t corner[2][3];
};

struct iso_triangulator {
    struct iso_triangulate_options options;
    size_t capacity_px;
    int width_px, height_px; /* of the frame triangulated last */
    int32_t *vertex;         /* of each pixel, -1 for none */
    struct cell *cells;      /* of each pixel, as the cell's upper left corner */
    int32_t (*adjacent)[3];  /* the neighbours of each triangle; only with largest_only */
    int32_t *piece;          /* the piece of each triangle; the same */
    int32_t *moved;          /* the new index of each triangle, -1 if dropped; the same */
};

int iso_triangulator_new(size_t capacity_px, const struct iso_triangulate_options *options,
                         struct iso_triangulator **out)
{
    if (capacity_px == 0 || capacity_px > INT32_MAX / 4 || !(options->jump_mm > 0.0)) {
        return -EINVAL;
    }
    struct iso_triangulator *t = calloc(1, sizeof *t);
    if (!t) {
        return -ENOMEM;
    }
    t->options = *options;
    t->capacity_px = capacity_px;
    t->vertex = calloc(capacity_px, sizeof *t->vertex);
    t->cells = calloc(capacity_px, sizeof *t->cells);
    bool whole = t->vertex && t->cells;
    if (options->largest_only) {
        t->adjacent = calloc(2 * capacity_px, sizeof *t->adjacent);
        t->piece = calloc(2 * capacity_px, sizeof *t->piece);
        t->moved = calloc(2 * capacity_px, sizeof *t->moved);
        whole = whole && t->adjacent && t->piece && t->moved;
    }
    if (!whole) {
        iso_triangulator_free(t);
        return -ENOMEM;
    }
    *out = t;
    return 0;
}

void iso_triangulator_free(struct iso_triangulator *triangulator)
{
    if (triangulator) {
        free(triangulator->vertex);
        free(triangulator->cells);
        free(triangulator->adjacent);
        free(triangulator->piece);
        free(triangulator->moved);
        free(triangulator);
    }
}

static int corner_pixel(const struct iso_triangulator *t, int cell, int corner)
{
    return cell + (corner & 1) + (corner >> 1) * t->width_px;
}

/* Chooses the triangles of one cell. */
static struct cell make_cell(const struct iso_frame *frame, int column, int row, double jump_mm)
{
    const struct iso_cell_list list = iso_frame_cell(frame, column, row, jump_mm).triangles;
    struct cell cell = {.count = list.count};
    for (int h = 0; h < list.count; h++) {
        for (int k = 0; k < 3; k++) {
            cell.corner[h][k] = iso_cell_corners[list.left_out[h]][k];
        }
    }
    return cell;
}

/* Makes the cells and the triangles. The corners of the triangles are indices of pixels until
 * number_vertices replaces them. Returns the number of triangles, or -ENOSPC. */
static int32_t make_triangles(struct iso_triangulator *t, const struct iso_frame *frame,
                              struct iso_mesh *mesh)
{
    int32_t n = 0;
    for (int row = 0; row < t->height_px; row++) {
        for (int column = 0; column < t->width_px; column++) {
            const int at = row * t->width_px + column;
            struct cell *cell = &t->cells[at];
            *cell = (struct cell){0};
            if (row + 1 == t->height_px || column + 1 == t->width_px) {
                continue;
            }
            *cell = make_cell(frame, column, row, t->options.jump_mm);
            cell->first = n;
            for (int h = 0; h < cell->count; h++, n++) {
                if (n == mesh->triangle_capacity) {
                    return -ENOSPC;
                }
                for (int k = 0; k < 3; k++) {
                    mesh->triangles[n][k] = corner_pixel(t, at, cell->corner[h][k]);
                }
            }
        }
    }
    return n;
}

/* Makes a vertex for each pixel that a triangle uses, and replaces the pixels of the triangles by
 * these vertices. */
static int number_vertices(struct iso_triangulator *t, const struct iso_frame *frame,
                           struct iso_mesh *mesh)
{
    const int n_px = t->width_px * t->height_px;
    for (int i = 0; i < n_px; i++) {
        t->vertex[i] = -1;
    }
    for (int32_t i = 0; i < mesh->n_triangles; i++) {
        for (int k = 0; k < 3; k++) {
            t->vertex[mesh->triangles[i][k]] = 0;
        }
    }
    int32_t n = 0;
    for (int i = 0; i < n_px; i++) {
        if (t->vertex[i] < 0) {
            continue;
        }
        if (n == mesh->vertex_capacity) {
            return -ENOSPC;
        }
        mesh->vertices_mm[n] = iso_frame_point_at(frame, i % t->width_px, i / t->width_px);
        t->vertex[i] = n++;
    }
    for (int32_t i = 0; i < mesh->n_triangles; i++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[i][k] = t->vertex[mesh->triangles[i][k]];
        }
    }
    mesh->n_vertices = n;
    return 0;
}

/* Removes the dropped triangles (moved -1) from a cell. */
static void thin_cell(const struct iso_triangulator *t, struct cell *cell)
{
    const struct cell before = *cell;
    cell->count = 0;
    for (int h = 0; h < before.count; h++) {
        const int32_t index = t->moved[before.first + h];
        if (index < 0) {
            continue;
        }
        cell->first = cell->count == 0 ? index : cell->first;
        for (int k = 0; k < 3; k++) {
            cell->corner[cell->count][k] = before.corner[h][k];
        }
        cell->count++;
    }
}

/* Drops all triangles but those of the largest piece, and numbers the vertices anew. */
static int keep_largest(struct iso_triangulator *t, const struct iso_frame *frame,
                        struct iso_mesh *mesh)
{
    iso_triangulate_adjacency(t, t->adjacent);
    const int32_t pieces = iso_mesh_components(mesh, (const int32_t(*)[3])t->adjacent, t->piece);
    if (pieces <= 1) {
        return pieces < 0 ? pieces : 0;
    }
    int32_t kept = 0;
    for (int32_t i = 0; i < mesh->n_triangles; i++) {
        t->moved[i] = t->piece[i] == 0 ? kept++ : -1;
    }
    mesh->n_triangles = kept;
    for (int i = 0; i < t->width_px * t->height_px; i++) {
        struct cell *cell = &t->cells[i];
        thin_cell(t, cell);
        for (int h = 0; h < cell->count; h++) {
            for (int k = 0; k < 3; k++) {
                mesh->triangles[cell->first + h][k] = corner_pixel(t, i, cell->corner[h][k]);
            }
        }
    }
    return number_vertices(t, frame, mesh);
}

int iso_triangulate(struct iso_triangulator *t, const struct iso_frame *frame,
                    struct iso_mesh *mesh)
{
    const int32_t n_px = frame->width_px * frame->height_px;
    if ((size_t)n_px > t->capacity_px) {
        return -ENOSPC;
    }
    t->width_px = frame->width_px;
    t->height_px = frame->height_px;
    mesh->n_vertices = mesh->n_triangles = 0;
    const int32_t n = make_triangles(t, frame, mesh);
    if (n <= 0) {
        return n < 0 ? n : -ENODATA;
    }
    mesh->n_triangles = n;
    int error = number_vertices(t, frame, mesh);
    if (!error && t->options.largest_only) {
        error = keep_largest(t, frame, mesh);
    }
    if (error) {
        mesh->n_vertices = mesh->n_triangles = 0;
    }
    return error;
}

/* Barycentric weights of (s, t) in a triangle of a cell's corners; false if it lies outside. */
static bool weigh_corners(const uint8_t corner[3], double s, double t, double weight[3])
{
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = corner[k] & 1;
        y[k] = corner[k] >> 1;
    }
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    weight[1] = ((s - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (t - y[0])) / area;
    weight[2] = ((x[1] - x[0]) * (t - y[0]) - (s - x[0]) * (y[1] - y[0])) / area;
    weight[0] = 1.0 - weight[1] - weight[2];
    return weight[0] >= -1e-12 && weight[1] >= -1e-12 && weight[2] >= -1e-12;
}

int iso_triangulate_locate(const struct iso_triangulator *triangulator, double column, double row,
                           struct iso_surface_point *point)
{
    const struct iso_triangulator *t = triangulator;
    if (t->width_px < 2 || t->height_px < 2 ||
        !(column >= 0.0 && row >= 0.0 && column <= t->width_px - 1 && row <= t->height_px - 1)) {
        return -ENOENT;
    }
    int u = (int)fmin(column, t->width_px - 2.0), v = (int)fmin(row, t->height_px - 2.0);
    const struct cell *cell = &t->cells[v * t->width_px + u];
    for (int h = 0; h < cell->count; h++) {
        struct iso_surface_point found = {.triangle = cell->first + h};
        if (weigh_corners(cell->corner[h], column - u, row - v, found.weight)) {
            for (int k = 0; k < 3; k++) {
                found.weight[k] = fmax(found.weight[k], 0.0);
            }
            *point = found;
            return 0;
        }
    }
    return -ENOENT;
}

/* The triangle of a cell that has both corners, other than `except`; -1 for none. */
static int32_t triangle_on(const struct cell *cell, int p, int q, int32_t except)
{
    for (int h = 0; h < cell->count; h++) {
        const uint8_t *c = cell->corner[h];
        const bool has_p = c[0] == p || c[1] == p || c[2] == p;
        bool has_q = c[0] == q || c[1] == q || c[2] == q;
        if (has_p && has_q && cell->first + h != except) {
            return cell->first + h;
        }
    }
    return -1;
}

/* The triangle across the edge between corners p < q of the cell at (column, row). */
static int32_t triangle_across(const struct iso_triangulator *t, int column, int row, int p, int q,
                               int32_t self)
{
    const struct cell *cell = &t->cells[row * t->width_px + column];
    if (p == 0 && q == 1) {
        return row > 0 ? triangle_on(cell - t->width_px, 2, 3, -1) : -1;
    }
    if (p == 2 && q == 3) {
        return row + 1 < t->height_px ? triangle_on(cell + t->width_px, 0, 1, -1) : -1;
    }
    if (p == 0 && q == 2) {
        return column > 0 ? triangle_on(cell - 1, 1, 3, -1) : -1;
    }
    if (p == 1 && q == 3) {
        return column + 1 < t->width_px ? triangle_on(cell + 1, 0, 2, -1) : -1;
    }
    return triangle_on(cell, p, q, self); /* a diagonal */
}

void iso_triangulate_adjacency(const struct iso_triangulator *triangulator, int32_t (*adjacent)[3])
{
    const struct iso_triangulator *t = triangulator;
    for (int row = 0; row < t->height_px; row++) {
        for (int column = 0; column < t->width_px; column++) {
            const struct cell *cell = &t->cells[row * t->width_px + column];
            for (int h = 0; h < cell->count; h++) {
                const int32_t self = cell->first + h;
                for (int k = 0; k < 3; k++) {
                    int p = cell->corner[h][(k + 1) % 3], q = cell->corner[h][(k + 2) % 3];
                    adjacent[self][k] = triangle_across(t, column, row, p < q ? p : q,
                                                        p < q ? q : p, self);
                }
            }
        }
    }
}
