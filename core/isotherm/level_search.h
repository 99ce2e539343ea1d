/* The common part of finding a level on meshes and on grids. Internal to core/isotherm. */
#ifndef ISO_CORE_ISOTHERM_LEVEL_SEARCH_H
#define ISO_CORE_ISOTHERM_LEVEL_SEARCH_H

#include <math.h>

/* The temperatures at the three corners of a triangle, in ascending order. */
struct iso__corner_heat {
    double low, middle, high;
};

/* Sorts three values by comparisons: fmin and fmax are calls. */
static inline struct iso__corner_heat iso__corner_heat(double h0, double h1, double h2)
{
    double low = h0 < h1 ? h0 : h1, high = h0 < h1 ? h1 : h0;
    low = h2 < low ? h2 : low;
    high = h2 > high ? h2 : high;
    return (struct iso__corner_heat){low, h0 + h1 + h2 - low - high, high};
}

/* The share of a triangle, 0..1, in which a linear function is at or above a level. */
static inline double iso__share_above(const struct iso__corner_heat *h, double level)
{
    if (level <= h->low) {
        return 1.0;
    }
    if (level > h->high) {
        return 0.0;
    }
    if (level > h->middle) {
        return (h->high - level) * (h->high - level) / ((h->high - h->low) * (h->high - h->middle));
    }
    return 1.0 - (level - h->low) * (level - h->low) / ((h->high - h->low) * (h->middle - h->low));
}

/* A search for a level. area_mm2 gives the area of the surface above a level, which falls as the
 * level rises. */
struct iso__level_search {
    double (*area_mm2)(const void *surface, double level);
    const void *surface;
    double wanted_mm2;
};

/* Returns the level with the wanted area above it, to 1e-6 of that area. The level lies between
 * `low` and `high`: the area above `low` is larger than the wanted one by f_low >= 0, and the area
 * above `high` is smaller by -f_high >= 0. Heat
 * decreases like a Gaussian, so that the area is nearly linear in the logarithm of the level, and
 * regula falsi in that logarithm (Illinois variant, Dowell and Jarratt 1971) needs few steps. */
double iso__level_between(const struct iso__level_search *search, double low, double f_low,
                          double high, double f_high);

#endif
