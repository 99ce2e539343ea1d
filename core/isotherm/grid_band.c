#include "core/isotherm/grid_band.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

int iso__grid_band_init(struct iso__grid_band *band, const struct iso_grid *grid)
{
    const size_t triangles = 2 * (size_t)grid->width * (size_t)grid->height;
    band->triangle = calloc(triangles, sizeof *band->triangle);
    band->run = calloc((size_t)grid->height, sizeof *band->run);
    return band->triangle && band->run ? 0 : -ENOMEM;
}

void iso__grid_band_done(struct iso__grid_band *band)
{
    free(band->triangle);
    free(band->run);
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

/* Makes the runs those of the whole window. */
static void reset_runs(struct iso__grid_band *band)
{
    const struct iso_grid_window *w = &band->field->window;
    for (int row = w->row; row + 1 < w->row + w->height; row++) {
        band->run[row] = (struct iso__grid_run){w->column, w->column + w->width - 1};
    }
    band->run_heat = 0.0f;
}

void iso__grid_band_begin(struct iso__grid_band *band, const struct iso_grid *grid,
                          const struct iso_grid_field *field)
{
    const struct iso_grid_window *w = &field->window;
    memset(band->key_mm2, 0, sizeof band->key_mm2);
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
    band->grid = grid;
    band->field = field;
    band->most = most;
    band->least = least;
    reset_runs(band);
}

/* Guesses the key of the level: adds the areas of the vertices from the hottest key down, and
 * returns the key at which the sum reaches the wanted area, or 1 if it never does. */
static uint32_t guess_key(const struct iso__grid_band *band, double wanted_mm2)
{
    double area = 0.0;
    for (uint32_t key = band->most; key >= band->least && key > 0; key--) {
        area += (double)band->key_mm2[key];
        if (area >= wanted_mm2) {
            return key;
        }
    }
    return 1;
}

/* Sorts a triangle of a cell with the heat at its corners: adds its area if it lies above the band,
 * stores it if it lies in the band, and skips it if it lies below. */
static void sort_triangle(struct iso__grid_band *band, int32_t at, uint8_t left_out,
                          const float heat[4])
{
    const uint8_t *corner = iso_cell_corners[left_out];
    const struct iso__corner_heat h = iso__corner_heat(
        (double)heat[corner[0]], (double)heat[corner[1]], (double)heat[corner[2]]);
    const float area_mm2 = band->grid->cell_mm2[left_out][at];
    if (h.low >= band->high) {
        band->above_mm2 += (double)area_mm2;
    } else if (h.high >= band->low) {
        band->triangle[band->n++] = (struct iso__grid_triangle){at, left_out, area_mm2, h};
    }
}

/* Sorts the triangles of one cell. */
static void sort_cell(struct iso__grid_band *band, int32_t at, const float heat[4])
{
    const uint8_t set = band->grid->cell[at];
    if (set ==
        ISO_CELL_FALLING) { /* one of these two, nearly always; as iso_cell_list orders them */
        sort_triangle(band, at, 1, heat);
        sort_triangle(band, at, 2, heat);
    } else if (set == ISO_CELL_RISING) {
        sort_triangle(band, at, 3, heat);
        sort_triangle(band, at, 0, heat);
    } else {
        const struct iso_cell_list list = iso_cell_list(set);
        for (int h = 0; h < list.count; h++) {
            sort_triangle(band, at, list.left_out[h], heat);
        }
    }
}

/* Whether a corner of the cell in column i, between two rows of heat, reaches a heat. */
static bool is_warm(const float *upper, const float *lower, int i, float heat)
{
    return upper[i] >= heat || upper[i + 1] >= heat || lower[i] >= heat || lower[i + 1] >= heat;
}

/* Shortens the run of a row to the cells that reach a heat, and what lies between them. */
static struct iso__grid_run shorten(struct iso__grid_run run, const float *upper,
                                    const float *lower, float heat)
{
    while (run.first < run.end && !is_warm(upper, lower, run.first, heat)) {
        run.first++;
    }
    while (run.first < run.end && !is_warm(upper, lower, run.end - 1, heat)) {
        run.end--;
    }
    return run;
}

/* Collects the triangles that a level between the two may cut. */
static void collect(struct iso__grid_band *band, double low, double high)
{
    const struct iso_grid *grid = band->grid;
    const struct iso_grid_window *w = &band->field->window;
    band->low = low;
    band->high = high;
    band->n = 0;
    band->above_mm2 = 0.0;
    const float cold = (float)low;
    if (cold < band->run_heat) {
        reset_runs(band);
    }
    for (int row = w->row; row + 1 < w->row + w->height; row++) {
        const float *upper = &band->field->value[row * grid->stride], *lower = upper + grid->stride;
        const struct iso__grid_run run = shorten(band->run[row], upper, lower, cold);
        band->run[row] = run;
        for (int i = run.first; i < run.end; i++) {
            const int32_t at = row * grid->stride + i;
            if (grid->cell[at] && is_warm(upper, lower, i, cold)) {
                const float heat[4] = {upper[i], upper[i + 1], lower[i], lower[i + 1]};
                sort_cell(band, at, heat);
            }
        }
    }
    band->run_heat = cold;
}

static double area_above(const void *surface, double level)
{
    const struct iso__grid_band *band = surface;
    double area = band->above_mm2;
    for (int32_t i = 0; i < band->n; i++) {
        const struct iso__grid_triangle *t = &band->triangle[i];
        area += iso__share_above(&t->heat, level) * (double)t->area_mm2;
    }
    return area;
}

int iso__grid_band_find(struct iso__grid_band *band, double radius_mm, double *level)
{
    const double wanted = M_PI * radius_mm * radius_mm;
    const struct iso__level_search search = {area_above, band, wanted};
    if (band->most == 0) {
        return -ERANGE;
    }
    const uint32_t key = guess_key(band, wanted), end = band->most + 1;
    uint32_t low = key > 2 ? key - 1 : 1, high = key + 2;
    for (;;) { /* until the level lies between low and high; each round widens the range */
        high = high < end ? high : end;
        collect(band, heat_of(low), heat_of(high));
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
