#include "sim/world/prop/sheet.h"

#include <errno.h>

#include "sim/base/noise3.h"

enum { ROWS = 81, COLUMNS = 81 };

/* An arc that starts level at the origin: converts the length `along` the sheet to a position
 * beside the axis and a depth away from it. */
static void bend(double radius_mm, double along_mm, double *beside_mm, double *away_mm)
{
    const double angle = along_mm / radius_mm;
    *beside_mm = radius_mm * sin(angle);
    *away_mm = radius_mm * (1.0 - cos(angle));
}

struct iso_vec3 sim_sheet_point(const struct sim_sheet *sheet, double x_mm, double y_mm)
{
    const double c = cos(sheet->axis_rad), s = sin(sheet->axis_rad);
    const double across = c * x_mm + s * y_mm, along_axis = c * y_mm - s * x_mm;
    double beside = across, away = 0.0;
    switch (sheet->shape) {
    case SIM_SHEET_ROLLED:
        bend(sheet->radius_mm, across, &beside, &away);
        break;
    case SIM_SHEET_S:
        bend(across < 0.0 ? -sheet->radius_mm : sheet->radius_mm, across, &beside, &away);
        break;
    case SIM_SHEET_CREASED:
        beside = cos(sheet->crease_rad) * across;
        away = sin(sheet->crease_rad) * fabs(across);
        break;
    case SIM_SHEET_FLAT:
        break;
    }
    return iso_vec3(c * beside - s * along_axis, s * beside + c * along_axis, away);
}

/* Half the breadth of a face's outline, as a share of the sheet's breadth, from the crown (-1)
 * to the chin (1): a superellipse that tapers over the jaw. */
static double outline_at(double down)
{
    const double breadth = pow(fmax(1.0 - pow(fabs(down), 2.4), 0.0), 1.0 / 2.4);
    return breadth * (1.0 - 0.22 * fmax(down, 0.0) * fmax(down, 0.0));
}

int sim_sheet_new(const struct sim_sheet *sheet, enum sim_material material, struct sim_solid **out)
{
    const bool round = sheet->shape == SIM_SHEET_ROLLED || sheet->shape == SIM_SHEET_S;
    if (!(sheet->width_mm > 0.0 && sheet->height_mm > 0.0) ||
        (round && !(fabs(sheet->radius_mm) > 0.0))) {
        return -EINVAL;
    }
    struct sim_solid *solid;
    const int error = sim_solid_sheet(ROWS, COLUMNS, material, &solid);
    if (error != 0) {
        return error;
    }
    for (int r = 0; r < ROWS; r++) {
        const double down = 2.0 * r / (ROWS - 1) - 1.0;
        const double breadth = sheet->outline ? outline_at(down) : 1.0;
        for (int c = 0; c < COLUMNS; c++) {
            const double x = 0.5 * sheet->width_mm * breadth * (2.0 * c / (COLUMNS - 1) - 1.0);
            const double y = 0.5 * sheet->height_mm * down;
            struct iso_vec3 p = sim_sheet_point(sheet, x, y);
            p.z += sheet->waves_mm * sim_noise3(sheet->key, iso_vec3(x / 70.0, y / 70.0, 0.5));
            solid->vertices_mm[r * COLUMNS + c] = p;
        }
    }
    *out = solid;
    return 0;
}
