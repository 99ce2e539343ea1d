/* The first k generalised eigenpairs L phi = lambda B phi. phi' B phi = 1, lambda ascending from 0.
 * Abdelrahman 2013, section 3.4.2.
 *
 * Block Lanczos in shift-invert mode with full reorthogonalisation over CHOLMOD (Grimes, Lewis and
 * Simon, "A shifted block Lanczos algorithm", SIAM J. Matrix Anal. Appl. 15, 1994). Blocks find
 * multiple eigenvalues, as symmetric and unconnected surfaces have them, and work at the speed of
 * matrix products. Whether none was missed is counted by Sylvester's law of inertia. No static
 * state: any number of threads may solve at once. */
#ifndef ISOTHERM_EIGENPAIRS_H
#define ISOTHERM_EIGENPAIRS_H

#include "isotherm/stiffness_mass.h"

struct iso_eigenpairs {
    int32_t n, k;
    double *lambda; /* [k], 1/mm^2 */
    double *phi;    /* [k][n], eigenvector i at phi + i n */
};

/* `tolerance` is relative, of the residual; 0 is machine precision. For faces 1e-10 is a good
 * choice. -EINVAL for k outside 1..n/2 (and for n < 8) or a negative tolerance, -EDOM if the
 * factorisation fails (matrix not positive definite or not finite), -ENOTRECOVERABLE if it does not
 * converge or an eigenvalue is of a multiplicity above 32, -ENOMEM. */
int iso_eigenpairs_new(const struct iso_symmetric *stiffness, const struct iso_symmetric *mass,
                       int32_t k, double tolerance, struct iso_eigenpairs **out)
    __attribute__((warn_unused_result));
void iso_eigenpairs_free(struct iso_eigenpairs *pairs);

#endif
