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
    /* Heat falls off like a Gaussian: where it is positive the logarithm of the level is bisected.
     */
    double least = high * 1e-12;
    low = fmax(low, least);
    if (iso_isotherm_area_above(mesh, heat, low) < wanted) {
        return -ERANGE;
    }
    enum { BISECTIONS_MAX = 60 };
    for (int i = 0; i < BISECTIONS_MAX; i++) {
        double middle = sqrt(low * high);
        double area = iso_isotherm_area_above(mesh, heat, middle);
        if (fabs(area - wanted) <= 1e-6 * wanted) {
            low = high = middle;
            break;
        }
        *(area > wanted ? &low : &high) = middle;
    }
    *level = sqrt(low * high);
    return 0;
}
