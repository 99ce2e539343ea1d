/* Principal components of displacement fields, and the removal of rigid motion from fields.
 *
 * A field is [n_vertices][3] floats in mm; several fields follow each other in memory. The
 * weight of a vertex is its share of the surface. */
#ifndef SIM_TRAIN_PRINCIPAL_H
#define SIM_TRAIN_PRINCIPAL_H

#include <stdint.h>

#include "isotherm/vec.h"

enum { SIM_FIELDS_MAX = 128 };

/* Computes the eigenvalues (falling) and eigenvectors (vector[k * n ..] belongs to value k, unit
 * length) of the symmetric row-major n x n matrix a, which is destroyed. It uses cyclic Jacobi
 * rotations (Golub and Van Loan, Matrix Computations, 8.5). The code is plain C, so that results
 * do not depend on the installed BLAS. */
void sim_symmetric_eigen(double *a, uint32_t n, double *value, double *vector);

/* Fits the six rigid motions to the weighted vertices of every field, and subtracts them from all
 * vertices. -EDOM for fewer than three weighted vertices, or if all are on one line. */
int sim_remove_rigid(const struct iso_vec3 *mean_mm, uint32_t n_vertices, const double *weight,
                     uint32_t n_fields, float *fields_mm) __attribute__((warn_unused_result));

/* Finds the n_keep components of largest weighted variance of sum_i c_i field_i, where the
 * coefficients c have the second moments `moment` ([n_fields][n_fields]; NULL: identity), by the
 * Gram-matrix method (Turk and Pentland 1991). Component k is in mm per standard deviation. Writes
 * components_mm[n_keep][n_vertices][3] and the weighted variance of every possible component,
 * variance[n_fields], falling, mm^2 summed over the weights. -EINVAL for more than SIM_FIELDS_MAX
 * fields or n_keep > n_fields; -ENOMEM. */
int sim_principal(const float *fields_mm, uint32_t n_fields, uint32_t n_vertices,
                  const double *weight, const double *moment, uint32_t n_keep, float *components_mm,
                  double *variance) __attribute__((warn_unused_result));

#endif
