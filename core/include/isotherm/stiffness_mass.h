/* Linear finite elements on a triangle mesh: the stiffness matrix L and the mass matrix B.
 *
 * L(i,j) = -(cot a_ij + cot b_ij) / 2 off the diagonal and minus the row's sum on it: symmetric
 * positive semi-definite, null vector constant, natural (Neumann) boundary. B consistent:
 * (|t_r| + |t_s|) / 12 off the diagonal, sum of incident |t| / 6 on it; lumped: sum of incident |t|
 * / 3. Abdelrahman 2013, eqs. 3.33 and 3.34 with the signs put right (the text's 3.34 is -L, and
 * its diagonal of 3.33 sums over incident triangles). Units: L has none, B is mm^2. */
#ifndef ISOTHERM_STIFFNESS_MASS_H
#define ISOTHERM_STIFFNESS_MASS_H

#include <stdint.h>

#include "isotherm/mesh.h"

/* Symmetric matrix in compressed columns, the lower triangle only, diagonal first in each column,
 * rows ascending. */
struct iso_symmetric {
    int32_t n;   /* order */
    int32_t nnz; /* entries stored */
    int32_t n_capacity, nnz_capacity;
    int32_t *column_start; /* [n + 1] */
    int32_t *row;          /* [nnz] */
    double *value;         /* [nnz] */
};

enum iso_mass {
    ISO_MASS_CONSISTENT,
    ISO_MASS_LUMPED, /* stored with the stiffness's pattern, zeros off the diagonal */
};

int iso_symmetric_new(int32_t n_capacity, int32_t nnz_capacity, struct iso_symmetric **out)
    __attribute__((warn_unused_result));
void iso_symmetric_free(struct iso_symmetric *matrix);

/* y = A x over the whole symmetric matrix. */
void iso_symmetric_multiply(const struct iso_symmetric *a, const double *x, double *y);

/* Assembles both matrices; they share one pattern. Refills matrices that have room (nnz is at most
 * n_vertices + 3 n_triangles). A degenerate triangle (area below 1e-12 of its longest edge squared)
 * adds nothing. Vertices in no triangle get an empty L and a unit mass, so that both stay
 * factorisable. -EINVAL for an invalid mesh, -ENOSPC for a matrix without room, -ENOMEM. */
int iso_stiffness_mass(const struct iso_mesh *mesh, enum iso_mass kind,
                       struct iso_symmetric *stiffness, struct iso_symmetric *mass)
    __attribute__((warn_unused_result));

/* The same on a weighted manifold: both integrals are taken with a density h > 0 that is given at
 * the vertices and linear between them (Abdelrahman 2013, 5.11 to 5.13 with the diagonal of 5.13 as
 * the negative sum of its row). h of 1 gives the matrices of iso_stiffness_mass. The matrices stay
 * symmetric and positive (semi-)definite and a constant stays a null vector of L. Heat flows as
 * dU/dt = (1/h) div(h grad U): it is kept within what is dense. -EINVAL also for a density that is
 * not above 0 or not finite. */
int iso_stiffness_mass_weighted(const struct iso_mesh *mesh, enum iso_mass kind,
                                const double *density, struct iso_symmetric *stiffness,
                                struct iso_symmetric *mass) __attribute__((warn_unused_result));

#endif
