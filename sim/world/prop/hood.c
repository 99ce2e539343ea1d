#include "sim/world/prop/hood.h"

#include "sim/base/noise3.h"

enum { ROWS = 50, COLUMNS = 80 };

static const double top_mm = 150.0, bottom_mm = -190.0; /* above and below the nose tip */
static const double middle_z_mm = -105.0;

/* The hood's breadth at a height, as a share of its full breadth: a dome that is wider on the
 * shoulders. */
static double breadth_at(double y_mm)
{
    const double rise = fmax(y_mm - 20.0, 0.0) / (top_mm - 20.0);
    const double fall = fmax(-90.0 - y_mm, 0.0) / 100.0;
    return sqrt(fmax(1.0 - rise * rise, 0.0)) + 0.35 * fall * fall;
}

int sim_hood_new(struct sim_random *random, struct sim_solid **out)
{
    struct sim_solid *solid;
    const int error = sim_solid_sheet(ROWS, COLUMNS, SIM_CLOTH, &solid);
    if (error != 0) {
        return error;
    }
    const double loose = sim_random_between(random, 8.0, 30.0);
    const double reach = sim_random_between(random, 1.9,
                                            2.4); /* angle around the head, from the back */
    const uint64_t key = sim_random_u64(random);
    for (int r = 0; r < ROWS; r++) {
        const double f = (double)r / (ROWS - 1);
        const double y = top_mm + loose +
                         (bottom_mm - top_mm - loose) * f * f; /* finer on the dome */
        const double breadth = breadth_at(fmin(y, top_mm));
        for (int c = 0; c < COLUMNS; c++) {
            const double angle = reach * (2.0 * c / (COLUMNS - 1) - 1.0); /* 0: the back */
            struct iso_vec3 outwards = {sin(angle), 0.0, -cos(angle)};
            struct iso_vec3 p = {breadth * (88.0 + loose) * outwards.x, y,
                                 middle_z_mm + breadth * (108.0 + loose) * outwards.z};
            const double folds = 6.0 * sim_noise3(key, iso_scale(1.0 / 50.0, p)) +
                                 2.0 * sim_noise3(key + 1, iso_scale(1.0 / 18.0, p));
            solid->vertices_mm[r * COLUMNS + c] = iso_madd(p, breadth * folds, outwards);
        }
    }
    *out = solid;
    return 0;
}
