/* Operations on several vectors at once, with which the direct heat solver treats several sources
 * together. Internal to core/heat.
 *
 * A block is [n][width * ISO_DOUBLES]: value i of every vector, then value i + 1 of every vector.
 * Each entry of a matrix is then read only once for all vectors and multiplied with whole
 * registers. (With one vector after another, reading the matrix takes most of the time.) The
 * vectors do not affect each other: each has the same operations in the same order at every width.
 *
 * The same source is compiled for the instructions that every processor of the architecture has
 * and, on x86-64, once more for AVX2 (without FMA), like the steps of the grid. The results are the
 * same to the bit. */
#ifndef ISO_CORE_HEAT_BLOCK_H
#define ISO_CORE_HEAT_BLOCK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/lanes.h"

enum { ISO_BLOCK_WIDTH_MAX = 3, ISO_BLOCK_MAX = ISO_BLOCK_WIDTH_MAX * ISO_DOUBLES };

enum { ISO_BLOCK_COLUMNS = 4 }; /* the most columns of `subtract` */

/* L and D of an LDL' by columns. Column j begins at start[j] with D(j, j); then come its count[j] -
 * 1 entries of L below the diagonal, rows ascending. If p is the first of these rows, the other
 * rows of column j are also rows of column p (as in the factor of any symmetric matrix). */
struct iso_ldl {
    int32_t n;
    const int32_t *start, *count, *row;
    const double *value;
    const struct iso_ldl_nodes *nodes; /* for the solves; NULL: not known */
};

/* Whether the rows below column j of L are j + 1 and those below column j + 1, j < n - 1: both are
 * columns of one supernode (supernodes.h). */
static inline bool iso_ldl_joins_next(const struct iso_ldl *l, int32_t j)
{
    return l->count[j] == l->count[j + 1] + 1 && l->row[l->start[j] + 1] == j + 1;
}

/* A supernode has the columns first to first + width - 1. Each of them has the same rows: these
 * columns, and n_below rows below them. */
struct iso_ldl_node {
    int32_t first, width, n_below;
    const int32_t *row; /* [width + n_below] */
};

/* All supernodes of a factor, ascending. The columns of a supernode share one list of rows here. In
 * L each column has a list of its own, so a solve reads less memory here. */
struct iso_ldl_nodes {
    int32_t count;
    struct iso_ldl_node *node; /* [count] */
    int32_t *of;               /* [n]: the supernode of each column */
    int32_t *rows;             /* the rows of all supernodes */
};

/* Finds the supernodes of L, whose values and nodes are not read. The caller frees *out by
 * iso_ldl_nodes_free. -EINVAL if L has no columns; -ENOMEM. */
int iso_ldl_nodes_new(const struct iso_ldl *l, struct iso_ldl_nodes **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_ldl_nodes_free(struct iso_ldl_nodes *nodes);

/* Marks the supernodes in which L^-1 e has entries, if e is 0 but for this row: the supernode of
 * the row and its ancestors in the elimination tree (Gilbert and Peierls, Sparse partial pivoting
 * in time proportional to arithmetic operations, SIAM J. Sci. Stat. Comput. 9, 1988). `reached` is
 * [count]; marks of earlier calls may be in it and stay. */
void iso_ldl_reach(const struct iso_ldl_nodes *nodes, int32_t row, bool *reached);

/* A sparse matrix by rows: row i from start[i] to start[i + 1]. */
struct iso_rows {
    int32_t n;
    const int32_t *start, *column;
    const double *value;
};

/* In all operations width is 1..ISO_BLOCK_WIDTH_MAX, and arrays of one number for each vector are
 * [width * ISO_DOUBLES]. `forward` and `backward` need l->nodes, `measure` does not. */
struct iso_block_ops {
    /* x = L^-1 x. If `reached` is not NULL, only supernodes that it marks are visited: all others
     * must be left 0 (iso_ldl_reach). */
    void (*forward)(const struct iso_ldl *l, const bool *reached, int width, double *x);
    /* x = (D L')^-1 x; energy = x' D^-1 x of each vector, with the x before: b' (L D L')^-1 b if
     * x was L^-1 b. */
    void (*backward)(const struct iso_ldl *l, int width, double *x, double *energy);
    /* Computes only the energies that `backward` computes, the same to the bit. */
    void (*measure)(const struct iso_ldl *l, int width, const double *x, double *energy);
    /* y = A x; form = x' y and total = 1' y of each vector. */
    void (*multiply)(const struct iso_rows *a, int width, const double *x, double *y, double *form,
                     double *total);
    /* io = weight[0] io + weight[1] u + weight[2] v, with weights of each vector. */
    void (*mix)(int32_t n, int width, const double weight[3][ISO_BLOCK_MAX], const double *u,
                const double *v, double *io);
    /* sum = sum over j of weight[j] block[j]. `block` holds n_blocks blocks one after the other,
     * each of vectors of n values. */
    void (*combine)(int32_t n, int width, const double *block, int n_blocks,
                    const double (*weight)[ISO_BLOCK_MAX], double *sum);
    /* Of single vectors, unlike the others: io -= sum over c of weight[c] column[c], of 1 to
     * ISO_BLOCK_COLUMNS columns. */
    void (*subtract)(int32_t n, int columns, const double *const *column, const double *weight,
                     double *io);
    const char *name;
};

/* For every processor of the architecture. */
extern const struct iso_block_ops iso__block_ops_baseline;
extern const struct iso_block_ops iso__block_ops_avx2; /* x86-64 only */

/* The fastest that this machine can run. */
const struct iso_block_ops *iso_block_ops(void);

/* x holds b before and (L D L')^-1 b afterwards; energy = b' x of each vector. */
static inline void iso_block_solve(const struct iso_block_ops *ops, const struct iso_ldl *l,
                                   int width, double *x, double *energy)
{
    ops->forward(l, NULL, width, x);
    ops->backward(l, width, x, energy);
}

#endif
