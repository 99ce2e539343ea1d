/* A symmetric matrix by rows, both triangles, with its rows and columns in another order: the order
 * of a factor, in which blocks of vectors are processed. Internal to core/heat. */
#ifndef ISO_CORE_HEAT_PERMUTED_H
#define ISO_CORE_HEAT_PERMUTED_H

#include "core/heat/block.h"
#include "isotherm/stiffness_mass.h"

/* Created once and refilled. */
struct iso_permuted {
    int32_t n_capacity, nnz_capacity; /* of the symmetric matrix */
    int32_t *start;                   /* [n + 1] */
    int32_t *column;                  /* [2 nnz - n] */
    double *value;                    /* the same */
    int32_t *place;                   /* [n], the inverse of the order */
};

/* Makes room for a matrix of these sizes. -EINVAL, -ENOMEM. */
int iso_permuted_new(int32_t n_capacity, int32_t nnz_capacity, struct iso_permuted **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_permuted_free(struct iso_permuted *matrix);

/* Refills the matrix: its row and column k are row and column order[k] of `a`. `order` must be a
 * permutation of 0..n - 1; this is not checked. *out is borrowed until the next call. -ENOSPC over
 * a capacity. */
int iso_permuted_fill(struct iso_permuted *matrix, const struct iso_symmetric *a,
                      const int32_t *order, struct iso_rows *out)
    __attribute__((warn_unused_result));

#endif
