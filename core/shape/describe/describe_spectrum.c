/* Methods that need no point: Shape-DNA and the temperature distribution. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/shape/describe/describe.h"
#include "isotherm/signature.h"

enum {
    DNA_VALUES = 15, /* Abdelrahman 2013, 4.2.3 */
    TD_BINS = 100,
};

/* Shape-DNA (Reuter, Wolter and Peinecke 2006): eigenvalues divided by the first one above 0. */
int iso_describe_shape_dna(const struct iso_shape *shape, const struct iso_describe_times *times,
                           struct iso_shape_description *out)
{
    (void)times;
    const int32_t sizes[] = {DNA_VALUES};
    const int error = iso_describe_parts(out, 1, sizes);
    const struct iso_eigenpairs *pairs = shape->pairs;
    for (int i = 1; !error && i <= DNA_VALUES && i < pairs->k; i++) {
        out->whole[i - 1] = pairs->lambda[1] > 0.0 ? (float)(pairs->lambda[i] / pairs->lambda[1])
                                                   : 0.0f;
    }
    return error;
}

/* The time of TD, in areas of the shape: heat has left the tips of the limbs, but not the limbs. */
static const double td_time = 1.0 / 64.0;

/* Temperature distribution (Fang, Sun, Kim and Ramani 2011; 3.4.5): the histogram of the heat mean
 * signature over the surface, from its lowest to its highest value. These lie close together: on
 * evenly spread vertices the mean is 1 / area minus the heat that stays at the vertex. */
int iso_describe_td(const struct iso_shape *shape, const struct iso_describe_times *times,
                    struct iso_shape_description *out)
{
    (void)times;
    const int32_t sizes[] = {TD_BINS};
    double *mean = malloc((size_t)shape->mesh->n_vertices * sizeof *mean);
    int error = mean ? iso_describe_parts(out, 1, sizes) : -ENOMEM;
    if (!error) {
        error = iso_heat_mean_signature(shape->pairs, td_time * shape->total_area, mean);
    }
    if (!error) {
        double least = mean[0], most = mean[0];
        for (int32_t v = 1; v < shape->mesh->n_vertices; v++) {
            least = fmin(least, mean[v]);
            most = fmax(most, mean[v]);
        }
        iso_describe_histogram(mean, shape->mesh->n_vertices, 1, shape->area, least, most, TD_BINS,
                               out->whole);
        for (int b = 0; b < TD_BINS; b++) {
            out->whole[b] /= (float)shape->total_area;
        }
    }
    free(mean);
    return error;
}
