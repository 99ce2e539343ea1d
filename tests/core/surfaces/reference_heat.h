/* The heat kernel to many digits, by a method that shares nothing with those under test: the
 * Chebyshev expansion of exp(-t B^-1 L) (Tal-Ezer 1989), B^-1 by conjugate gradients. No
 * factorisation, no Krylov space, no eigenpairs. */
#ifndef TESTS_CORE_SURFACES_REFERENCE_HEAT_H
#define TESTS_CORE_SURFACES_REFERENCE_HEAT_H

#include "isotherm/mesh.h"
#include "tests/core/surfaces/matrices.h"

/* Heat column of one source at n_times times, out[j * n] for time j, relative error about 1e-11.
 * Ends the test if it cannot get that far. */
void reference_heat(const struct iso_mesh *mesh, const struct matrices *m,
                    struct iso_surface_point source, const double *t_mm2, int n_times, double *out);

#endif
