/* The dissertation's way to eigenpairs, for the benchmark: ARPACK's shift-invert Lanczos (Lehoucq,
 * Sorensen and Yang 1998) over core's CHOLMOD factor, as a user of Debian's packages would have it.
 */
#ifndef TESTS_BENCH_PEERS_HEAT_ARPACK_H
#define TESTS_BENCH_PEERS_HEAT_ARPACK_H

#include "isotherm/stiffness_mass.h"

/* k eigenpairs of L phi = lambda B phi nearest to the shift < 0, ascending: lambda [k], phi [k][n].
 * -ENOMEM, -ENOTRECOVERABLE if ARPACK gives up, errors of the factorisation. ARPACK keeps static
 * state: one thread at a time. */
int peer_arpack(const struct iso_symmetric *stiffness, const struct iso_symmetric *mass, int k,
                double shift, double *lambda, double *phi) __attribute__((warn_unused_result));

#endif
