#include "isotherm/signature.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

enum { ROWS = 256 }; /* vertices at a time, so that the squares need little memory */

static const double steps_of_spread = 7.0; /* Aubry, Schlickewei and Cremers 2011, section 4.3 */

int iso_wave_energies(const struct iso_eigenpairs *pairs, int n, double *energy, double *spread)
{
    if (n < 2 || pairs->k < 3 || !(pairs->lambda[1] > 0.0) ||
        !(pairs->lambda[pairs->k - 1] > pairs->lambda[1])) {
        return -EINVAL;
    }
    const double low = log(pairs->lambda[1]), high = log(pairs->lambda[pairs->k - 1]);
    /* high - low = (n - 1) steps and two spreads at each end. */
    const double step = (high - low) / (n - 1 + 4.0 * steps_of_spread);
    *spread = steps_of_spread * step;
    for (int j = 0; j < n; j++) {
        energy[j] = low + 2.0 * *spread + j * step;
    }
    return 0;
}

/* weight [k - 1][n], with the sum 1 for each energy. */
static void fill_weights(const struct iso_eigenpairs *pairs, const double *energy, int n,
                         double spread, double *weight)
{
    for (int j = 0; j < n; j++) {
        double sum = 0.0;
        for (int32_t i = 1; i < pairs->k; i++) {
            const double away = (energy[j] - log(pairs->lambda[i])) / spread;
            weight[(i - 1) * n + j] = exp(-0.5 * away * away);
            sum += weight[(i - 1) * n + j];
        }
        for (int32_t i = 1; i < pairs->k && sum > 0.0; i++) {
            weight[(i - 1) * n + j] /= sum;
        }
    }
}

int iso_wave_signature(const struct iso_eigenpairs *pairs, const double *energy, int n,
                       double spread, double *out)
{
    const size_t n_vertices = (size_t)pairs->n, k = (size_t)pairs->k - 1;
    double *square = malloc(k * ROWS * sizeof *square);
    double *weight = malloc(k * (size_t)n * sizeof *weight);
    const int error = square && weight ? 0 : -ENOMEM;
    if (!error) {
        fill_weights(pairs, energy, n, spread, weight);
    }
    for (size_t from = 0; !error && from < n_vertices; from += ROWS) {
        const size_t rows = n_vertices - from < ROWS ? n_vertices - from : ROWS;
        for (size_t i = 0; i < k; i++) {
            const double *phi = &pairs->phi[(i + 1) * n_vertices + from];
            for (size_t r = 0; r < rows; r++) {
                square[i * ROWS + r] = phi[r] * phi[r];
            }
        }
        cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, (int)rows, n, (int)k, 1.0, square,
                    ROWS, weight, n, 0.0, &out[from * (size_t)n], n);
    }
    free(square);
    free(weight);
    return error;
}
