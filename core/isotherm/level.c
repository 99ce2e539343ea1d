#include "isotherm/isotherm_curve.h"

#include <errno.h>
#include <math.h>

#include "core/isotherm/level_search.h"

double iso_isotherm_area_above(const struct iso_mesh *mesh, const double *heat, double level)
{
    double area = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        const struct iso__corner_heat h = iso__corner_heat(heat[v[0]], heat[v[1]], heat[v[2]]);
        const double share = iso__share_above(&h, level);
        if (share > 0.0) {
            area += share * iso_mesh_triangle_area(mesh, t);
        }
    }
    return area;
}

double iso__level_between(const struct iso__level_search *search, double low, double f_low,
                          double high, double f_high)
{
    enum { STEPS_MAX = 100 };
    double x_low = log(low), x_high = log(high), x = x_low, f = f_low;
    int side = 0; /* which end moved last */
    for (int i = 0; i < STEPS_MAX && fabs(f) > 1e-6 * search->wanted_mm2; i++) {
        x = (x_low * f_high - x_high * f_low) / (f_high - f_low);
        f = search->area_mm2(search->surface, exp(x)) - search->wanted_mm2;
        if (f > 0.0) {
            f_high *= side == 1 ? 0.5 : 1.0;
            x_low = x;
            f_low = f;
            side = 1;
        } else {
            f_low *= side == -1 ? 0.5 : 1.0;
            x_high = x;
            f_high = f;
            side = -1;
        }
    }
    return exp(x);
}

/* A mesh and the heat on all of it. */
struct whole {
    const struct iso_mesh *mesh;
    const double *heat;
};

static double area_of_whole(const void *surface, double level)
{
    const struct whole *whole = surface;
    return iso_isotherm_area_above(whole->mesh, whole->heat, level);
}

int iso_isotherm_level(const struct iso_mesh *mesh, const double *heat, double radius_mm,
                       double *level)
{
    const double wanted = M_PI * radius_mm * radius_mm;
    double low = INFINITY, high = -INFINITY;
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        low = heat[i] < low ? heat[i] : low;
        high = heat[i] > high ? heat[i] : high;
    }
    if (!(low < high)) {
        return -ERANGE;
    }
    double x_low = log(fmax(low, high * 1e-12)), x_high = log(high);
    double f_low = iso_isotherm_area_above(mesh, heat, exp(x_low)) - wanted, f_high = -wanted;
    if (f_low < 0.0) {
        return -ERANGE;
    }
    const struct whole whole = {mesh, heat};
    const struct iso__level_search search = {area_of_whole, &whole, wanted};
    *level = iso__level_between(&search, exp(x_low), f_low, exp(x_high), f_high);
    return 0;
}
