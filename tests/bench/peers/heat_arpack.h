/* The dissertation's method for eigenpairs, for comparison: ARPACK's shift-invert Lanczos (Lehoucq,
 * Sorensen and Yang 1998) over core's CHOLMOD factor, with Debian's package. */
#ifndef TESTS_BENCH_PEERS_HEAT_ARPACK_H
#define TESTS_BENCH_PEERS_HEAT_ARPACK_H

#include "isotherm/stiffness_mass.h"

/* Computes the k eigenpairs of L phi = lambda B phi nearest to the shift < 0, ascending: lambda
 * [k], phi [k][n]. -ENOMEM, -ENOTRECOVERABLE if ARPACK fails, errors of the factorisation. ARPACK
 * has static state, so only one thread at a time may call this. */
int peer_arpack(const struct iso_symmetric *stiffness, const struct iso_symmetric *mass, int k,
                double shift, double *lambda, double *phi) __attribute__((warn_unused_result));

#endif
