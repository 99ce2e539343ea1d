/* Cholesky factor of a L + b B, by CHOLMOD and supernodes.h. Both general solvers of the heat
 * kernel use it.
 *
 * Only CHOLMOD's simplicial LDL' is used, because its supernodal module is under the GPL. Later
 * factors with the same analysis are computed by supernodes.h. The symbolic analysis is kept while
 * the pattern stays the same. The pattern is compared each time: if it had changed, CHOLMOD would
 * give wrong results and no error. A new pattern is ordered by minimum degree (AMD), which is fast.
 * When it comes back the first time, it is ordered by nested dissection (CHOLMOD's own, with
 * METIS), and from then on each factor is smaller. This changes the last digits of results once.
 * Counting eigenvalues keeps the ordering. Only one thread at a time may use a factor.
 *
 * CHOLMOD solves for few columns. For many at once, such as all sources of heat, block.h uses the
 * factor directly. */
#ifndef ISO_CORE_HEAT_FACTOR_H
#define ISO_CORE_HEAT_FACTOR_H

#include "isotherm/stiffness_mass.h"

struct iso_factor;
struct iso_ldl; /* block.h, internal to core/heat */

/* Makes room for matrices up to the given size. There is no factor yet. -EINVAL, -ENOMEM. */
int iso_factor_new(int32_t n_capacity, int32_t nnz_capacity, struct iso_factor **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_factor_free(struct iso_factor *factor);

/* Factorises a * stiffness + b * mass (one pattern, as iso_stiffness_mass makes them). -EINVAL if
 * the patterns differ in size or have no columns, -ENOSPC over the capacity, -EDOM if the sum is
 * not positive definite or not finite, -ENOMEM. */
int iso_factor_compute(struct iso_factor *factor, double a, const struct iso_symmetric *stiffness,
                       double b, const struct iso_symmetric *mass)
    __attribute__((warn_unused_result));

/* Counts the eigenvalues of stiffness x = lambda mass x that lie below `limit`: as many as the LDL'
 * of stiffness - limit * mass has negative pivots (Sylvester's law of inertia; Parlett, The
 * Symmetric Eigenvalue Problem, 1980, section 3.3). There is no factor afterwards. Errors as for
 * iso_factor_compute, except that the matrix may be indefinite; -EDOM also if a pivot is 0, as for
 * a limit that is itself an eigenvalue. */
int iso_factor_count_below(struct iso_factor *factor, const struct iso_symmetric *stiffness,
                           double limit, const struct iso_symmetric *mass, int32_t *count)
    __attribute__((warn_unused_result));

/* Solves for n_right columns at once: right and solution are [n_right][n], and may be the same.
 * -EDOM if there is no factor, -ENOMEM. */
int iso_factor_solve(struct iso_factor *factor, const double *right, int n_right, double *solution)
    __attribute__((warn_unused_result));

/* Gives access to the factor, for code that works in the order of the factor (block.h): row k of L
 * is row (*order)[k] of the matrix. *ldl and *order are borrowed: they are valid until the next
 * call that computes or counts. -EDOM if there is no factor. */
int iso_factor_ldl(const struct iso_factor *factor, struct iso_ldl *ldl, const int32_t **order)
    __attribute__((warn_unused_result));

#endif
