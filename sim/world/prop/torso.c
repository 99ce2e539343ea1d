#include "sim/world/prop/torso.h"

#include <stddef.h>

#include "sim/base/noise3.h"
#include "sim/base/random.h"

enum { ROWS = 60, COLUMNS = 72 };

/* The trunk's cross-sections, ellipses, from the collar down (mean adult; heights relative to the
 * nose tip). */
static const struct section {
    double y_mm, half_width_mm, half_depth_mm, z_mm;
} sections[] = {
    {-128.0, 64.0, 58.0, -128.0},   {-150.0, 84.0, 72.0, -126.0},   {-166.0, 135.0, 84.0, -126.0},
    {-186.0, 182.0, 92.0, -126.0},  {-222.0, 214.0, 100.0, -126.0}, {-300.0, 226.0, 114.0, -128.0},
    {-420.0, 215.0, 120.0, -130.0}, {-640.0, 205.0, 116.0, -130.0},
};

static struct section section_at(double y_mm)
{
    size_t last = sizeof sections / sizeof *sections - 1, i = 0;
    while (i + 1 < last && y_mm < sections[i + 1].y_mm) {
        i++;
    }
    const struct section *a = &sections[i], *b = &sections[i + 1];
    const double f = (y_mm - a->y_mm) / (b->y_mm - a->y_mm);
    return (struct section){y_mm, a->half_width_mm + f * (b->half_width_mm - a->half_width_mm),
                            a->half_depth_mm + f * (b->half_depth_mm - a->half_depth_mm),
                            a->z_mm + f * (b->z_mm - a->z_mm)};
}

int sim_torso_new(uint64_t key, struct sim_solid **out)
{
    struct sim_solid *solid;
    const int error = sim_solid_sheet(ROWS, COLUMNS, SIM_CLOTH, &solid);
    if (error != 0) {
        return error;
    }
    struct sim_random random = sim_random_seeded(key, sim_random_hash("torso"), 0);
    const double breadth = sim_random_between(&random, 0.88, 1.12);
    const double depth = sim_random_between(&random, 0.92, 1.15);
    const double top = sections[0].y_mm,
                 bottom = sections[sizeof sections / sizeof *sections - 1].y_mm;
    for (int r = 0; r < ROWS; r++) {
        const double f = (double)r / (ROWS - 1);
        struct section s = section_at(top + (bottom - top) * f * f); /* finer near the collar */
        for (int c = 0; c < COLUMNS; c++) {
            const double angle = 2.0 * 3.14159265358979 * c / (COLUMNS - 1); /* 0: the back */
            struct iso_vec3 p = {breadth * s.half_width_mm * sin(angle), s.y_mm,
                                 s.z_mm - depth * s.half_depth_mm * cos(angle)};
            const double folds = 5.0 * sim_noise3(key + 1, iso_scale(1.0 / 45.0, p)) +
                                 2.0 * sim_noise3(key + 2, iso_scale(1.0 / 16.0, p));
            struct iso_vec3 outwards = iso_unit(iso_vec3(p.x, 0.0, p.z - s.z_mm));
            solid->vertices_mm[r * COLUMNS + c] = iso_madd(p, folds, outwards);
        }
    }
    *out = solid;
    return 0;
}
