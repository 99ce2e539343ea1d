/* The stiffness matrix and the mass matrix of a test's mesh. */
#ifndef TESTS_CORE_SURFACES_MATRICES_H
#define TESTS_CORE_SURFACES_MATRICES_H

#include "isotherm/stiffness_mass.h"

struct matrices {
    struct iso_symmetric *stiffness, *mass;
};

/* Allocates and computes the matrices of a mesh. A failure ends the test. */
struct matrices matrices_of(const struct iso_mesh *mesh, enum iso_mass kind);
/* Frees both matrices. */
void matrices_free(struct matrices *m);

/* Returns x' A y. */
double matrices_form(const struct iso_symmetric *a, const double *x, const double *y);

#endif
