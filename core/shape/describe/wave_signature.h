/* Wave kernel signature (Aubry, Schlickewei and Cremers, "The wave kernel signature: a quantum
 * mechanical approach to shape analysis", ICCV Workshops 2011): how likely a quantum particle whose
 * energy is about e is found at a vertex. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_WAVE_SIGNATURE_H
#define ISO_CORE_SHAPE_DESCRIBE_WAVE_SIGNATURE_H

#include "isotherm/eigenpairs.h"

/* n energies, evenly spaced between the logarithms of the first and the last eigenvalue above 0,
 * two spreads away from both ends, and *spread, the standard deviation of the energies, which is
 * seven of their steps. -EINVAL for n < 2 or for fewer than two different eigenvalues above 0;
 * the outputs are then unchanged. */
int iso_wave_energies(const struct iso_eigenpairs *pairs, int n, double *energy, double *spread)
    __attribute__((warn_unused_result));

/* out [n_vertices][n]: the mean of phi_i(x)^2, weighted by exp(-(e - log lambda_i)^2 / (2
 * spread^2)), without the trivial pair. -ENOMEM. */
int iso_wave_signature(const struct iso_eigenpairs *pairs, const double *energy, int n,
                       double spread, double *out) __attribute__((warn_unused_result));

#endif
