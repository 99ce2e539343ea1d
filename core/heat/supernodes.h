/* Numeric LDL' by supernodes, into a pattern that is known from an earlier factor. Internal to
 * core/heat.
 *
 * A supernode is a run of columns of L that have the same rows below it (Ng and Peyton, Block
 * sparse Cholesky algorithms on advanced uniprocessor computers, SIAM J. Sci. Comput. 14, 1993).
 * Its columns are dense, one beside the other, and what it contributes to a later one is a product
 * of dense matrices. Each supernode is computed from all earlier ones that have rows in it ("left
 * looking"). Wide ones are cut into pieces, so that a piece stays in the cache.
 *
 * CHOLMOD's simplicial LDL' computes the same numbers entry by entry, which takes several times as
 * long. CHOLMOD also has a supernodal module, but that is under the GPL. Pivots are not exchanged,
 * and D may have negative entries: the count of eigenvalues needs them. */
#ifndef ISO_CORE_HEAT_SUPERNODES_H
#define ISO_CORE_HEAT_SUPERNODES_H

#include "core/heat/block.h"
#include "isotherm/stiffness_mass.h"

struct iso_supernodes;

/* Finds the supernodes of a factor's pattern. `order` is that of the factor: row k of L is row
 * order[k] of `pattern`, whose values are not read. The arrays of the pattern of L are borrowed.
 * -EINVAL if an entry of `pattern` has no place in L; -ENOMEM. */
int iso_supernodes_new(const struct iso_ldl *l, const int32_t *order,
                       const struct iso_symmetric *pattern, struct iso_supernodes **out)
    __attribute__((warn_unused_result));

/* Frees it. NULL is accepted. */
void iso_supernodes_free(struct iso_supernodes *nodes);

/* Writes L and D of `matrix`, which has the pattern given before, to `value`, the values of that
 * L. -EDOM if a pivot is 0 or not finite; then `value` is no factor. */
int iso_supernodes_factorise(struct iso_supernodes *nodes, const struct iso_symmetric *matrix,
                             double *value) __attribute__((warn_unused_result));

#endif
