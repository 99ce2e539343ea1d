/* The first k generalised eigenpairs L phi = lambda B phi, by ARPACK in shift-invert mode over
 * CHOLMOD (Lehoucq, Sorensen and Yang 1998, mode 3). phi' B phi = 1, lambda ascending from 0.
 * Abdelrahman 2013, section 3.4.2. ARPACK keeps static state: one call at a time in a process. */
#ifndef ISO_CORE_HEAT_EIGENPAIRS_H
#define ISO_CORE_HEAT_EIGENPAIRS_H

#include "core/heat/stiffness_mass.h"

struct iso_eigenpairs {
    int32_t n, k;
    double *lambda; /* [k], 1/mm^2 */
    double *phi;    /* [k][n], eigenvector i at phi + i n */
};

/* `tolerance` is relative; 0 is machine precision. A surface with symmetries has eigenvalues that
 * are exactly multiple, of which a looser tolerance may miss copies: 0 finds them; where there are
 * none (faces), 1e-10 is a good choice. -EINVAL for k outside 1..n/2 (and for n < 8) or a negative
 * tolerance, -EDOM if the factorisation fails (matrix not positive definite or not finite),
 * -ENOTRECOVERABLE if ARPACK does not converge, -ENOMEM. */
int iso_eigenpairs_new(const struct iso_symmetric *stiffness, const struct iso_symmetric *mass,
                       int32_t k, double tolerance, struct iso_eigenpairs **out)
    __attribute__((warn_unused_result));
void iso_eigenpairs_free(struct iso_eigenpairs *pairs);

#endif
