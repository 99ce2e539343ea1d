#include "core/isotherm/grid_band.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/isotherm/level_search.h"

int iso__grid_band_init(struct iso__grid_band *band, const struct iso_grid *grid)
{
    const size_t triangles = 2 * (size_t)grid->width * (size_t)grid->height;
    band->triangle = calloc(triangles, sizeof *band->triangle);
    return band->triangle ? 0 : -ENOMEM;
}

void iso__grid_band_done(struct iso__grid_band *band)
{
    free(band->triangle);
}

static uint32_t key_of(float heat)
{
    uint32_t bits;
    memcpy(&bits, &heat, sizeof bits);
    return bits >> ISO__GRID_KEY_SHIFT;
}

/* The least heat with that key. */
static double heat_of(uint32_t key)
{
    uint32_t bits = key << ISO__GRID_KEY_SHIFT;
    float heat;
    memcpy(&heat, &bits, sizeof heat);
    return (double)heat;
}

/* Guesses the key of the level: adds the areas of the vertices from the hottest key down, and
 * returns the key at which the sum reaches the wanted area, or 1 if it never does. *hottest is the
 * largest key; 0 if no vertex has heat. */
static uint32_t guess_key(struct iso__grid_band *band, const struct iso_grid *grid,
                          const struct iso_grid_field *field, double wanted_mm2, uint32_t *hottest)
{
    const struct iso_grid_window *w = &field->window;
    uint32_t most = 0, least = ISO__GRID_KEYS - 1;
    for (int row = w->row; row < w->row + w->height; row++) {
        const float *heat = &field->value[row * grid->stride + w->column];
        const float *share = &grid->share_mm2[row * grid->stride + w->column];
        for (int i = 0; i < w->width; i++) {
            if (heat[i] > 0.0f) {
                const uint32_t key = key_of(heat[i]);
                band->key_mm2[key] += share[i];
                most = key > most ? key : most;
                least = key < least ? key : least;
            }
        }
    }
    double area = 0.0;
    uint32_t found = 1;
    for (uint32_t key = most; key >= least && key > 0; key--) {
        area += (double)band->key_mm2[key];
        band->key_mm2[key] = 0.0f;
        if (found == 1 && area >= wanted_mm2) {
            found = key;
        }
    }
    band->key_mm2[0] = 0.0f;
    *hottest = most;
    return found;
}

static float least_of(const float v[3])
{
    const float low = v[0] < v[1] ? v[0] : v[1];
    return v[2] < low ? v[2] : low;
}

static float most_of(const float v[3])
{
    const float high = v[0] > v[1] ? v[0] : v[1];
    return v[2] > high ? v[2] : high;
}

/* Sorts the triangles of one cell: adds the area of those above the band, stores those in the band,
 * and skips those below it. */
static void sort_cell(struct iso__grid_band *band, const struct iso_grid *grid, int32_t at,
                      const float heat[4])
{
    const struct iso_cell_list list = iso_cell_list(grid->cell[at]);
    for (int h = 0; h < list.count; h++) {
        struct iso__grid_triangle t = {
            at, list.left_out[h], grid->cell_mm2[list.left_out[h]][at], {0}};
        for (int k = 0; k < 3; k++) {
            t.heat[k] = heat[iso_cell_corners[t.left_out][k]];
        }
        if ((double)least_of(t.heat) >= band->high) {
            band->above_mm2 += (double)t.area_mm2;
        } else if ((double)most_of(t.heat) >= band->low) {
            band->triangle[band->n++] = t;
        }
    }
}

/* Collects the triangles that a level between the two may cut. */
static void collect(struct iso__grid_band *band, const struct iso_grid *grid,
                    const struct iso_grid_field *field, double low, double high)
{
    const struct iso_grid_window *w = &field->window;
    band->low = low;
    band->high = high;
    band->n = 0;
    band->above_mm2 = 0.0;
    const float cold = (float)low;
    for (int row = w->row; row + 1 < w->row + w->height; row++) {
        int32_t at = row * grid->stride + w->column;
        const float *upper = &field->value[at], *lower = upper + grid->stride;
        for (int i = 0; i + 1 < w->width; i++, at++) {
            const float heat[4] = {upper[i], upper[i + 1], lower[i], lower[i + 1]};
            const bool warm = heat[0] >= cold || heat[1] >= cold || heat[2] >= cold ||
                              heat[3] >= cold;
            if (warm && grid->cell[at]) {
                sort_cell(band, grid, at, heat);
            }
        }
    }
}

static double area_above(const void *surface, double level)
{
    const struct iso__grid_band *band = surface;
    double area = band->above_mm2;
    for (int32_t i = 0; i < band->n; i++) {
        const struct iso__grid_triangle *t = &band->triangle[i];
        const double share = iso__share_above((double)t->heat[0], (double)t->heat[1],
                                              (double)t->heat[2], level);
        area += share * (double)t->area_mm2;
    }
    return area;
}

int iso__grid_band_find(struct iso__grid_band *band, const struct iso_grid *grid,
                        const struct iso_grid_field *field, double radius_mm, double *level)
{
    const double wanted = M_PI * radius_mm * radius_mm;
    const struct iso__level_search search = {area_above, band, wanted};
    uint32_t hottest, key = guess_key(band, grid, field, wanted, &hottest);
    if (hottest == 0) {
        return -ERANGE;
    }
    uint32_t low = key > 2 ? key - 1 : 1, high = key + 2;
    for (;;) { /* until the level lies between low and high; each round widens the range */
        high = high < hottest + 1 ? high : hottest + 1;
        collect(band, grid, field, heat_of(low), heat_of(high));
        const double f_low = area_above(band, band->low) - wanted;
        double f_high = area_above(band, band->high) - wanted;
        if (f_low >= 0.0 && f_high <= 0.0) {
            *level = iso__level_between(&search, band->low, f_low, band->high, f_high);
            return 0;
        }
        const bool too_high = !(f_low >= 0.0);
        if (too_high && low == 1) {
            return -ERANGE;
        }
        const uint32_t width = high - low;
        if (too_high) {
            low = low > width ? low - width : 1;
        }
        high = f_high > 0.0 ? high + width : high;
    }
}
