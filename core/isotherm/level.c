#include "isotherm/isotherm_curve.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

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

/* A triangle that a level of the search may cut. */
struct candidate {
    struct iso__corner_heat heat;
    double area_mm2;
};

/* What a search between two levels has to look at: the other triangles are wholly above or wholly
 * below every level of it. */
struct band {
    struct candidate *candidate; /* [n] */
    int32_t n;
    double above_mm2; /* area of the triangles that are wholly above */
};

static double area_of_band(const void *surface, double level)
{
    const struct band *band = surface;
    double area = band->above_mm2;
    for (int32_t i = 0; i < band->n; i++) {
        area += iso__share_above(&band->candidate[i].heat, level) * band->candidate[i].area_mm2;
    }
    return area;
}

/* Collects the triangles between two levels. The caller has allocated `band` for all triangles of
 * the mesh. */
static void collect(const struct iso_mesh *mesh, const double *heat, double low, double high,
                    struct band *band)
{
    band->n = 0;
    band->above_mm2 = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        const struct iso__corner_heat h = iso__corner_heat(heat[v[0]], heat[v[1]], heat[v[2]]);
        if (h.low >= high) {
            band->above_mm2 += iso_mesh_triangle_area(mesh, t);
        } else if (h.high >= low) {
            band->candidate[band->n++] = (struct candidate){h, iso_mesh_triangle_area(mesh, t)};
        }
    }
}

/* A level with too much area above it, and one with too little; by how much, in mm^2. */
struct bracket {
    double low, f_low, high, f_high;
};

/* Goes down from the hottest place by factors that grow, because the level is most often near it,
 * and collects the triangles of the bracket. False if the area above the lowest level is too small,
 * too. */
static bool find_bracket(const struct iso_mesh *mesh, const double *heat, double lowest,
                         double highest, double wanted_mm2, struct band *band, struct bracket *out)
{
    static const int halvings[] = {2, 4, 8, 16, 40};
    *out = (struct bracket){.high = highest, .f_high = -wanted_mm2};
    for (size_t i = 0; i < sizeof halvings / sizeof *halvings; i++) {
        out->low = fmax(ldexp(highest, -halvings[i]), lowest);
        collect(mesh, heat, out->low, out->high, band);
        out->f_low = area_of_band(band, out->low) - wanted_mm2;
        if (out->f_low >= 0.0) {
            return true;
        }
        if (out->low <= lowest) {
            return false;
        }
        out->high = out->low;
        out->f_high = out->f_low;
    }
    return false;
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
    if (!(low < high) || !(high > 0.0)) {
        return -ERANGE;
    }
    struct band band = {.candidate = malloc((size_t)mesh->n_triangles * sizeof *band.candidate)};
    struct bracket bracket;
    if (!band.candidate) {
        return -ENOMEM;
    }
    const bool found = find_bracket(mesh, heat, fmax(low, high * 1e-12), high, wanted, &band,
                                    &bracket);
    if (found) {
        const struct iso__level_search search = {area_of_band, &band, wanted};
        *level = iso__level_between(&search, bracket.low, bracket.f_low, bracket.high,
                                    bracket.f_high);
    }
    free(band.candidate);
    return found ? 0 : -ERANGE;
}
