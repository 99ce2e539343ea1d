#include "isotherm/heat_kernel.h"

#include <math.h>
#include <string.h>

void iso_heat_spectral(const struct iso_eigenpairs *pairs, const struct iso_mesh *mesh,
                       const struct iso_surface_point *sources, int n_sources, const double *t_mm2,
                       int n_times, double *out)
{
    const size_t n = (size_t)pairs->n;
    memset(out, 0, (size_t)n_sources * (size_t)n_times * n * sizeof *out);
    for (int s = 0; s < n_sources; s++) {
        const int32_t *corner = mesh->triangles[sources[s].triangle];
        for (int32_t i = 0; i < pairs->k; i++) {
            const double *phi = &pairs->phi[(size_t)i * n];
            double at_source = 0.0;
            for (int k = 0; k < 3; k++) {
                at_source += sources[s].weight[k] * phi[corner[k]];
            }
            for (int j = 0; j < n_times; j++) {
                const double factor = exp(-pairs->lambda[i] * t_mm2[j]) * at_source;
                double *column = &out[((size_t)s * (size_t)n_times + (size_t)j) * n];
                for (size_t v = 0; v < n; v++) {
                    column[v] += factor * phi[v];
                }
            }
        }
    }
}
