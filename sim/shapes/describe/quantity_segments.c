/* The quantity "segments" (quantity.h). */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/shape/describe/persistence.h"
#include "isotherm/signature.h"
#include "sim/shapes/describe/quantity.h"

/* Appends the segments, and all peaks with their persistence. Takes the memory of `segments`,
 * except for its peaks. */
static int add_segment_arrays(const struct iso_segments *segments, int32_t n_vertices,
                              struct sim_arrays *arrays)
{
    const struct sim_array segment = {.name = "segment",
                                      .meaning = "the segment of each vertex, from 0",
                                      .type = SIM_ARRAY_INT,
                                      .rows = n_vertices,
                                      .data = segments->segment,
                                      .owned = segments->segment};
    const size_t n = (size_t)segments->n_peaks;
    int32_t *vertex = malloc(n * sizeof *vertex);
    double *persistence = malloc(n * sizeof *persistence);
    int error = sim_arrays_add(arrays, &segment);
    if (error || !vertex || !persistence) {
        free(vertex);
        free(persistence);
        return -ENOMEM;
    }
    for (size_t p = 0; p < n; p++) {
        vertex[p] = segments->peak[p].vertex;
        persistence[p] = segments->peak[p].persistence;
    }
    const struct sim_array peak = {
        .name = "peak",
        .meaning = "the vertex of each peak; the first ones have segments",
        .type = SIM_ARRAY_INT,
        .rows = segments->n_peaks,
        .data = vertex,
        .owned = vertex};
    error = sim_quantity_add(arrays, "peak_persistence", "height of each peak above its pass",
                             persistence, segments->n_peaks, 0);
    if (error) {
        free(vertex);
        return error;
    }
    return sim_arrays_add(arrays, &peak);
}

int sim_quantity_segments(const struct iso_shape *shape, const struct sim_quantity_options *options,
                          struct sim_arrays *arrays)
{
    const double time = SIM_QUANTITY_MEAN_TIME * shape->total_area;
    const int32_t n = shape->mesh->n_vertices;
    struct iso_segments segments = {0};
    double *heat = malloc((size_t)n * sizeof *heat);
    int error = heat ? iso_heat_signature(shape->pairs, 0, &time, 1, heat) : -ENOMEM;
    double low = INFINITY, high = -INFINITY;
    for (int32_t v = 0; v < n && !error; v++) {
        low = fmin(low, heat[v]);
        high = fmax(high, heat[v]);
    }
    if (!error) {
        error = iso_shape_segments(shape, heat, options->persistence * (high - low), &segments);
    }
    free(heat);
    if (!error) {
        error = add_segment_arrays(&segments, n, arrays);
        free(segments.peak);
    }
    return error;
}
