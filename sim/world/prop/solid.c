#include "sim/world/prop/solid.h"

#include <errno.h>
#include <stdlib.h>

int sim_solid_new(uint32_t n_vertices, uint32_t n_triangles, enum sim_material material,
                  struct sim_solid **out)
{
    if (n_vertices == 0 || n_triangles == 0) {
        return -EINVAL;
    }
    struct sim_solid *solid = calloc(1, sizeof *solid);
    if (!solid) {
        return -ENOMEM;
    }
    *solid = (struct sim_solid){n_vertices, n_triangles, NULL, NULL, material, NULL};
    solid->vertices_mm = calloc(n_vertices, sizeof *solid->vertices_mm);
    solid->triangles = calloc(n_triangles, sizeof *solid->triangles);
    if (!solid->vertices_mm || !solid->triangles) {
        sim_solid_free(solid);
        return -ENOMEM;
    }
    *out = solid;
    return 0;
}

void sim_solid_free(struct sim_solid *solid)
{
    if (!solid) {
        return;
    }
    free(solid->vertices_mm);
    free(solid->triangles);
    free(solid->albedo);
    free(solid);
}

int sim_solid_sheet(uint32_t rows, uint32_t columns, enum sim_material material,
                    struct sim_solid **out)
{
    if (rows < 2 || columns < 2 || rows > 4096 || columns > 4096) {
        return -EINVAL;
    }
    struct sim_solid *solid;
    const int error = sim_solid_new(rows * columns, 2 * (rows - 1) * (columns - 1), material,
                                    &solid);
    if (error != 0) {
        return error;
    }
    uint32_t n = 0;
    for (uint32_t r = 0; r + 1 < rows; r++) {
        for (uint32_t c = 0; c + 1 < columns; c++) {
            const uint32_t a = r * columns + c, b = a + 1, d = a + columns, e = d + 1;
            uint32_t two[2][3] = {{a, d, b}, {b, d, e}};
            for (int k = 0; k < 3; k++) {
                solid->triangles[n][k] = two[0][k];
                solid->triangles[n + 1][k] = two[1][k];
            }
            n += 2;
        }
    }
    *out = solid;
    return 0;
}

int sim_solid_rectangle(double width_mm, double height_mm, double bend_radius_mm,
                        enum sim_material material, struct sim_solid **out)
{
    enum { ROWS = 9, COLUMNS = 25 };
    if (!(width_mm > 0.0 && height_mm > 0.0 && bend_radius_mm >= 0.0)) {
        return -EINVAL;
    }
    struct sim_solid *solid;
    const int error = sim_solid_sheet(ROWS, COLUMNS, material, &solid);
    if (error != 0) {
        return error;
    }
    for (int r = 0; r < ROWS; r++) {
        for (int c = 0; c < COLUMNS; c++) {
            const double s = width_mm * ((double)c / (COLUMNS - 1) - 0.5);
            const double y = height_mm * ((double)r / (ROWS - 1) - 0.5);
            const double angle = bend_radius_mm > 0.0 ? s / bend_radius_mm : 0.0;
            const double x = bend_radius_mm > 0.0 ? bend_radius_mm * sin(angle) : s;
            const double z = bend_radius_mm * (1.0 - cos(angle));
            solid->vertices_mm[r * COLUMNS + c] = iso_vec3(x, y, z);
        }
    }
    *out = solid;
    return 0;
}

int sim_solid_box(struct iso_vec3 size_mm, enum sim_material material, struct sim_solid **out)
{
    static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    if (!(size_mm.x > 0.0 && size_mm.y > 0.0 && size_mm.z > 0.0)) {
        return -EINVAL;
    }
    struct sim_solid *solid;
    const int error = sim_solid_new(8, 12, material, &solid);
    if (error != 0) {
        return error;
    }
    for (uint32_t i = 0; i < 8; i++) {
        solid->vertices_mm[i] = iso_vec3(size_mm.x * (i & 1 ? 0.5 : -0.5),
                                         size_mm.y * (i & 2 ? 0.5 : -0.5),
                                         size_mm.z * (i & 4 ? 0.5 : -0.5));
    }
    for (int f = 0; f < 6; f++) {
        for (int k = 0; k < 3; k++) {
            solid->triangles[2 * f][k] = faces[f][k];
            solid->triangles[2 * f + 1][k] = faces[f][k == 0 ? 0 : k + 1];
        }
    }
    *out = solid;
    return 0;
}

void sim_solid_move(struct sim_solid *solid, const struct iso_rigid *to_from)
{
    for (uint32_t i = 0; i < solid->n_vertices; i++) {
        solid->vertices_mm[i] = iso_rigid_apply(to_from, solid->vertices_mm[i]);
    }
}

int sim_solid_draw(const struct sim_solid *solid, const struct iso_rigid *camera_from_solid,
                   struct iso_vec3 *scratch_mm, struct sim_view *view)
{
    for (uint32_t i = 0; i < solid->n_vertices; i++) {
        scratch_mm[i] = iso_rigid_apply(camera_from_solid, solid->vertices_mm[i]);
    }
    const int error = sim_view_draw(view, scratch_mm, (const uint32_t(*)[3])solid->triangles,
                                    solid->n_triangles, solid->material);
    if (error == 0 && solid->albedo) {
        sim_view_paint(view, solid->albedo, solid->n_triangles);
    }
    return error;
}
