/* The heat kernel with many correct digits, by a method that has nothing in common with the methods
 * under test: the Chebyshev expansion of exp(-t B^-1 L) (Tal-Ezer 1989), with B^-1 by conjugate
 * gradients. It uses no factorisation, no Krylov space and no eigenpairs. */
#ifndef TESTS_CORE_SURFACES_REFERENCE_HEAT_H
#define TESTS_CORE_SURFACES_REFERENCE_HEAT_H

#include "isotherm/mesh.h"
#include "tests/core/surfaces/matrices.h"

/* Computes the heat columns of one source at n_times <= 8 times: the column of time j begins at
 * out[j * n], n is the number of vertices. The relative error is about 1e-11. The test ends if the
 * function does not reach this accuracy. */
void reference_heat(const struct iso_mesh *mesh, const struct matrices *m,
                    struct iso_surface_point source, const double *t_mm2, int n_times, double *out);

#endif
