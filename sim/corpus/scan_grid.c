#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "sim/corpus/scan_file.h"

static const double edge_max_mm = 12.0;

int sim_scan_grid_new(const char *name, double rows, double columns, struct sim_scan_grid *out,
                      struct iso_fault *fault)
{
    const bool sane = rows >= 2.0 && rows <= SIM_SCAN_SIDE_MAX && columns >= 2.0 &&
                      columns <= SIM_SCAN_SIDE_MAX && rows * columns <= SIM_SCAN_POINTS_MAX &&
                      rows == floor(rows) && columns == floor(columns);
    if (!sane) {
        return iso_fault_set(fault, -EBADMSG, "%s: %g rows of %g points", name, rows, columns);
    }
    struct sim_scan_grid grid = {.rows = (int)rows, .columns = (int)columns};
    grid.point_mm = calloc((size_t)grid.rows * (size_t)grid.columns, sizeof *grid.point_mm);
    if (!grid.point_mm) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    *out = grid;
    return 0;
}

void sim_scan_grid_done(struct sim_scan_grid *grid)
{
    free(grid->point_mm);
    *grid = (struct sim_scan_grid){0};
}

static bool joined(struct iso_vec3 a, struct iso_vec3 b)
{
    return iso_norm(iso_sub(a, b)) <= edge_max_mm; /* false for a NAN */
}

static void add_triangle(const struct sim_scan_grid *grid, const int32_t *vertex, int a, int b,
                         int c, struct iso_mesh *mesh)
{
    const struct iso_vec3 *p = grid->point_mm;
    if (joined(p[a], p[b]) && joined(p[b], p[c]) && joined(p[c], p[a])) {
        int32_t *t = mesh->triangles[mesh->n_triangles++];
        t[0] = vertex[a];
        t[1] = vertex[b];
        t[2] = vertex[c];
    }
}

static void join(const struct sim_scan_grid *grid, int32_t *vertex, struct iso_mesh *mesh)
{
    for (int i = 0; i < grid->rows * grid->columns; i++) {
        vertex[i] = -1;
        if (!isnan(grid->point_mm[i].x)) {
            vertex[i] = mesh->n_vertices;
            mesh->vertices_mm[mesh->n_vertices++] = grid->point_mm[i];
        }
    }
    for (int row = 0; row + 1 < grid->rows; row++) {
        for (int column = 0; column + 1 < grid->columns; column++) {
            const int a = row * grid->columns + column, b = a + 1, c = a + grid->columns, d = c + 1;
            add_triangle(grid, vertex, a, c, b, mesh);
            add_triangle(grid, vertex, b, c, d, mesh);
        }
    }
}

int sim_scan_grid_mesh(const char *name, const struct sim_scan_grid *grid, struct iso_mesh **out,
                       struct iso_fault *fault)
{
    const int32_t n = grid->rows * grid->columns;
    struct iso_mesh *mesh = NULL;
    int32_t *vertex = calloc((size_t)n, sizeof *vertex);
    if (!vertex || iso_mesh_new(n, 2 * n, &mesh)) {
        free(vertex);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    join(grid, vertex, mesh);
    free(vertex);
    if (mesh->n_triangles == 0) {
        iso_mesh_free(mesh);
        return iso_fault_set(fault, -EBADMSG, "%s: no surface in it", name);
    }
    *out = mesh;
    return 0;
}
