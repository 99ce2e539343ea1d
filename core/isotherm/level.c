#include "core/isotherm/isotherm.h"

#include <errno.h>
#include <math.h>

/* The part of a triangle in which a linear function with corner values h is at or above a level. */
static double share_above(double h0, double h1, double h2, double level)
{
    /* Sort so that low <= middle <= high. */
    double low = fmin(h0, fmin(h1, h2)), high = fmax(h0, fmax(h1, h2));
    double middle = h0 + h1 + h2 - low - high;
    if (level <= low) {
        return 1.0;
    }
    if (level > high) {
        return 0.0;
    }
    if (level > middle) {
        return (high - level) * (high - level) / ((high - low) * (high - middle));
    }
    return 1.0 - (level - low) * (level - low) / ((high - low) * (middle - low));
}

double iso_isotherm_area_above(const struct iso_mesh *mesh, const double *heat, double level)
{
    double area = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        double share = share_above(heat[v[0]], heat[v[1]], heat[v[2]], level);
        if (share > 0.0) {
            area += share * iso_mesh_triangle_area(mesh, t);
        }
    }
    return area;
}

int iso_isotherm_level(const struct iso_mesh *mesh, const double *heat, double radius_mm,
                       double *level)
{
    double wanted = M_PI * radius_mm * radius_mm;
    double low = INFINITY, high = -INFINITY;
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        low = fmin(low, heat[i]);
        high = fmax(high, heat[i]);
    }
    if (!(low < high) || iso_isotherm_area_above(mesh, heat, low) < wanted) {
        return -ERANGE;
    }
    /* Heat falls off like a Gaussian, so that area is nearly linear in the logarithm of the level:
     * regula falsi there (Illinois variant, Dowell and Jarratt 1971) needs few steps, each a pass
     * over the mesh. */
    double x_low = log(fmax(low, high * 1e-12)), x_high = log(high);
    double f_low = iso_isotherm_area_above(mesh, heat, exp(x_low)) - wanted, f_high = -wanted;
    if (f_low < 0.0) {
        return -ERANGE;
    }
    enum { STEPS_MAX = 100 };
    double x = x_low, f = f_low;
    int side = 0; /* which end moved last */
    for (int i = 0; i < STEPS_MAX && fabs(f) > 1e-6 * wanted; i++) {
        x = (x_low * f_high - x_high * f_low) / (f_high - f_low);
        f = iso_isotherm_area_above(mesh, heat, exp(x)) - wanted;
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
    *level = exp(x);
    return 0;
}
