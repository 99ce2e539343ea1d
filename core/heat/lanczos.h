/* The basis that block Lanczos builds for isotherm/eigenpairs.h.
 *
 * A = (L + s B)^-1 B is self-adjoint in the inner product x' B y; its largest eigenvalues 1 /
 * (lambda + s) belong to the smallest lambda. The vectors of V are orthonormal in that product, and
 * T = V' B A V. All of A V lies in V, except for the part that comes from the last block of V; that
 * part is the next block, `pending`; after a restart this holds again from the next step on. Every
 * new block is made orthogonal to all of V, twice.
 *
 * Only V is stored, which is most of the memory. V' B w is computed as V' (B w): multiplying a
 * block by B costs less than reading V does. */
#ifndef ISO_CORE_HEAT_LANCZOS_H
#define ISO_CORE_HEAT_LANCZOS_H

#include "core/heat/factor.h"

struct iso_lanczos {
    const struct iso_symmetric *mass;
    struct iso_factor *factor; /* of L + s B */
    int32_t n, block, capacity;
    int32_t size;      /* vectors of V to which A was applied */
    int32_t last;      /* how many of these the last block had */
    int32_t pending;   /* vectors of the next block, which follow; 0 if V is the whole space */
    double *v;         /* [capacity + block][n]: V */
    double *bv;        /* [block][n]: B applied to the next block */
    double *bw;        /* [block][n]: B w, working memory */
    double *t;         /* [capacity][capacity]: T by columns */
    double *coupling;  /* [block][block]: column c has the coefficients, in the next block, of A
                          applied to vector c of the last one */
    double *w;         /* [block][n]: working memory */
    double *projected; /* [block][capacity + block]: working memory */
    uint64_t random;   /* state of the generator of random numbers */
};

/* Begins a basis with one block of random vectors. `factor` is that of L + s B; mass and factor
 * must outlive the basis. `capacity` is the most vectors of V, at most the order of the matrices.
 * -ENOMEM, -EDOM; iso_lanczos_done is needed after an error as well. */
int iso_lanczos_init(struct iso_lanczos *l, const struct iso_symmetric *mass,
                     struct iso_factor *factor, int32_t block, int32_t capacity)
    __attribute__((warn_unused_result));

/* Replaces the first `columns` vectors of V by V times `vectors` [columns][size], some rows at a
 * time, so that no second V is needed. -ENOMEM. */
int iso_lanczos_rotate(struct iso_lanczos *l, const double *vectors, int32_t columns)
    __attribute__((warn_unused_result));

/* Restarts the basis with `keep` of the eigenvectors of T, `vectors` [keep][size] with `values`
 * [keep] (thick restart: Wu and Simon, SIAM J. Matrix Anal. Appl. 22, 2000). The pending block
 * stays the next one. What T has of them is diagonal; the next step adds how that block is coupled
 * to them. After it, the last block again is all that A leads out of V. -ENOMEM. */
int iso_lanczos_restart(struct iso_lanczos *l, const double *vectors, const double *values,
                        int32_t keep) __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_lanczos_done(struct iso_lanczos *l);

/* Applies A to the pending block and makes the next one. -EDOM, -ENOMEM from the solver. */
int iso_lanczos_step(struct iso_lanczos *l) __attribute__((warn_unused_result));

#endif
