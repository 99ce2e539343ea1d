#include "sim/world/prop/print.h"

#include <errno.h>
#include <stdlib.h>

enum { SIDE_MAX = 2000 };

static void place_vertices(struct sim_solid *sheet, int columns, int rows, double width_mm,
                           double height_mm, double bend_radius_mm)
{
    for (int r = 0; r <= rows; r++) {
        for (int c = 0; c <= columns; c++) {
            const double s = width_mm * ((double)c / columns - 0.5);
            const double y = height_mm * ((double)r / rows - 0.5);
            const double angle = bend_radius_mm > 0.0 ? s / bend_radius_mm : 0.0;
            const double x = bend_radius_mm > 0.0 ? bend_radius_mm * sin(angle) : s;
            sheet->vertices_mm[r * (columns + 1) + c] = iso_vec3(
                x, y, bend_radius_mm * (1.0 - cos(angle)));
        }
    }
}

static int put_ink_on(struct sim_solid *sheet, const float *albedo)
{
    sheet->albedo = malloc(sheet->n_triangles * sizeof *sheet->albedo);
    if (!sheet->albedo) {
        return -ENOMEM;
    }
    for (uint32_t t = 0; t < sheet->n_triangles; t++) {
        sheet->albedo[t] = albedo[t / 2];
    }
    return 0;
}

int sim_print_new(double width_mm, double height_mm, double bend_radius_mm, const float *albedo,
                  int columns, int rows, struct sim_solid **out)
{
    struct sim_solid *sheet;
    if (!(width_mm > 0.0 && height_mm > 0.0 && bend_radius_mm >= 0.0) || columns < 1 || rows < 1 ||
        columns > SIDE_MAX || rows > SIDE_MAX) {
        return -EINVAL;
    }
    int error = sim_solid_sheet((uint32_t)rows + 1, (uint32_t)columns + 1, SIM_PAPER, &sheet);
    if (error != 0) {
        return error;
    }
    place_vertices(sheet, columns, rows, width_mm, height_mm, bend_radius_mm);
    error = albedo ? put_ink_on(sheet, albedo) : 0;
    if (error != 0) {
        sim_solid_free(sheet);
        return error;
    }
    *out = sheet;
    return 0;
}
