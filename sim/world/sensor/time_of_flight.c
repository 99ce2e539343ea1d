#include "sim/world/sensor/time_of_flight.h"

#include <math.h>
#include <stdbool.h>

static double albedo(enum sim_material material)
{
    switch (material) {
    case SIM_HAIR:
        return 0.25;
    case SIM_CLOTH:
        return 0.6;
    case SIM_SKIN:
    case SIM_WALL:
    case SIM_PAPER:
        return 0.9;
    case SIM_PLASTIC:
        return 0.7;
    case SIM_GLASS:
        return 0.2;
    case SIM_NOTHING:
    case SIM_MIRROR:
        break;
    }
    return 0.0;
}

static bool is_inside(const struct sim_view *view, int column, int row)
{
    return column >= 0 && row >= 0 && column < view->camera.width_px &&
           row < view->camera.height_px;
}

struct sim_mixed_pixel sim_time_of_flight_mix(const struct sim_view *view, int column, int row,
                                              int reach)
{
    const int s = view->supersample, side = s + 2 * reach;
    double sum = 0.0, weighted = 0.0, nearest = 1e9, farthest = 0.0;
    int n = 0;
    for (int k = 0; k < side * side; k++) {
        const int u = column * s - reach + k % side, v = row * s - reach + k / side;
        if (!is_inside(view, u, v)) {
            continue;
        }
        n++;
        const size_t i = (size_t)v * (size_t)view->camera.width_px + (size_t)u;
        const double z = (double)view->depth_mm[i];
        if (!(z > 0.0)) {
            continue;
        }
        const double amplitude = albedo((enum sim_material)view->material[i]) *
                                 (double)view->cosine[i];
        sum += amplitude;
        weighted += amplitude * z;
        nearest = fmin(nearest, z);
        farthest = fmax(farthest, z);
    }
    if (!(sum > 0.0)) {
        return (struct sim_mixed_pixel){0.0, 0.0, 0.0};
    }
    return (struct sim_mixed_pixel){weighted / sum, sum / n, farthest - nearest};
}
