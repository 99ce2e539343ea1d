#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "isotherm/correspondence.h"
#include "isotherm/signature.h"

enum { ENERGIES = 60, FUNCTIONS = ISO_MATCH_FUNCTIONS, TIMES = FUNCTIONS - ENERGIES };

/* Times of the heat kernel signatures, in areas of the shape. */
static const double time_first = 1.0 / 400.0, time_last = 0.5;

/* Functions [n_vertices][FUNCTIONS] of a shape, which the caller frees: wave kernel signatures, and
 * heat kernel signatures without their constant. */
static int sign(const struct iso_shape *shape, const double *energy, double spread, double **out)
{
    const size_t n = (size_t)shape->mesh->n_vertices;
    double t[TIMES];
    double *wave = malloc(n * ENERGIES * sizeof *wave), *heat = malloc(n * TIMES * sizeof *heat);
    double *function = malloc(n * FUNCTIONS * sizeof *function);
    iso_heat_times(time_first * shape->total_area, time_last * shape->total_area, TIMES, t);
    int error = wave && heat && function
                    ? iso_wave_signature(shape->pairs, energy, ENERGIES, spread, wave)
                    : -ENOMEM;
    if (!error) {
        error = iso_heat_signature(shape->pairs, 1, t, TIMES, heat);
    }
    for (size_t v = 0; v < n && !error; v++) {
        double *row = &function[v * FUNCTIONS];
        memcpy(row, &wave[v * ENERGIES], ENERGIES * sizeof *row);
        memcpy(row + ENERGIES, &heat[v * TIMES], TIMES * sizeof *row);
    }
    free(wave);
    free(heat);
    *out = function;
    return error;
}

static int match(const struct iso_shape *from, const struct iso_shape *to,
                 const struct iso_match_options *options, int32_t k_last, int32_t *point, double *c)
{
    const int32_t k = options->first_pairs < k_last ? options->first_pairs : k_last;
    double energy[ENERGIES], spread = 0.0;
    double *own = NULL, *other = NULL;
    /* Both shapes are looked at with the energies of one of them. */
    int error = iso_wave_energies(from->pairs, ENERGIES, energy, &spread);
    if (!error) {
        error = sign(from, energy, spread, &own);
    }
    if (!error) {
        error = sign(to, energy, spread, &other);
    }
    const struct iso_shared_functions functions = {FUNCTIONS, own, other};
    if (!error) {
        error = iso_functional_map_fit(from, to, k, &functions, options->weight, c);
    }
    if (!error) {
        error = iso_zoom_out(from, to, k, c, options->step, k_last, point);
    }
    free(own);
    free(other);
    return error ? error : iso_functional_map_of(from, to, k_last, point, c);
}

int iso_shape_match(const struct iso_shape *from, const struct iso_shape *to,
                    const struct iso_match_options *options, int32_t *point, double *c)
{
    if (options->first_pairs < 2 || options->step < 1 || !(options->weight > 0.0)) {
        return -EINVAL;
    }
    const int32_t a = from->pairs->k, b = to->pairs->k;
    return match(from, to, options, a < b ? a : b, point, c);
}
