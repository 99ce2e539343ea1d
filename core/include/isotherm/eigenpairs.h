/** @file
 * The first k generalised eigenpairs L phi = lambda B phi of a surface, with phi' B phi = 1 and
 * lambda ascending from 0 (Abdelrahman 2013, section 3.4.2).
 *
 * The solver is block Lanczos in shift-invert mode with full reorthogonalisation; CHOLMOD
 * factorises the shifted matrix (Grimes, Lewis and Simon, "A shifted block Lanczos algorithm for
 * solving sparse symmetric generalized eigenproblems", SIAM J. Matrix Anal. Appl. 15, 1994). A
 * block of vectors finds multiple eigenvalues, which symmetric and disconnected surfaces have, and
 * its work is matrix products, which are fast. The solver uses Sylvester's law of inertia to check
 * that it found every eigenvalue. It has no static state, so any number of threads may use it at
 * the same time. */
#ifndef ISOTHERM_EIGENPAIRS_H
#define ISOTHERM_EIGENPAIRS_H

#include "isotherm/stiffness_mass.h"

/** Eigenpairs. They own their arrays. */
struct iso_eigenpairs {
    int32_t n;      /**< Values of an eigenvector: vertices of the mesh. */
    int32_t k;      /**< How many pairs there are. */
    double *lambda; /**< [k]: eigenvalues, 1/mm^2, ascending. */
    double *phi;    /**< [k][n]: eigenvector i begins at phi + i n. */
};

/** Computes the first eigenpairs.
 *
 * @param stiffness  L, from iso_stiffness_mass().
 * @param mass       B, from the same call.
 * @param k          How many pairs, 1..n/2; n is at least 8.
 * @param tolerance  Relative, of the residual; 0: machine precision. 1e-10 is a good choice for
 *                   faces.
 * @param out        Receives the pairs; free them with iso_eigenpairs_free().
 * @return 0; -EINVAL for a count or tolerance out of range; -EDOM if the factorisation fails (a
 *         matrix is not positive definite or not finite); -ENOTRECOVERABLE if the method does not
 *         converge or an eigenvalue is of a multiplicity above 32; -ENOMEM. */
int iso_eigenpairs_new(const struct iso_symmetric *stiffness, const struct iso_symmetric *mass,
                       int32_t k, double tolerance, struct iso_eigenpairs **out)
    __attribute__((warn_unused_result));

/** Frees eigenpairs.
 *
 * @param pairs  The pairs, or NULL. */
void iso_eigenpairs_free(struct iso_eigenpairs *pairs);

#endif
