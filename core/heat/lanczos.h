/* The basis that block Lanczos builds for isotherm/eigenpairs.h.
 *
 * A = (L + s B)^-1 B is self-adjoint in the inner product x' B y; its largest eigenvalues 1 /
 * (lambda + s) belong to the smallest lambda. The vectors of V are orthonormal in that product, and
 * T = V' B A V. All of A V lies in V, except for the part that comes from the last block of V; that
 * part is the next block, `pending`. Every new block is made orthogonal to all of V, twice. */
#ifndef ISO_CORE_HEAT_LANCZOS_H
#define ISO_CORE_HEAT_LANCZOS_H

#include "core/heat/factor.h"

struct iso_lanczos {
    const struct iso_symmetric *mass;
    struct iso_factor *factor; /* of L + s B */
    int32_t n, block, capacity;
    int32_t size;     /* vectors of V that A has been applied to */
    int32_t last;     /* of these, how many the last block had */
    int32_t pending;  /* vectors of the next block, behind them; 0 if V is the whole space */
    double *v, *bv;   /* [capacity + block][n]: V and B V */
    double *t;        /* [capacity][capacity]: T by columns */
    double *coupling; /* [last][pending] by columns: what A sends from the last block to the next */
    double *w;        /* [block][n] */
    double *projected; /* [block][capacity + block] */
    uint64_t random;
};

/* For a matrix of order n; the borrowed factor is of L + s B. capacity <= n. -ENOMEM, -EDOM. */
int iso_lanczos_init(struct iso_lanczos *l, const struct iso_symmetric *mass,
                     struct iso_factor *factor, int32_t block, int32_t capacity)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_lanczos_done(struct iso_lanczos *l);

/* Applies A to the pending block and makes the next one. -EDOM, -ENOMEM from the solver. */
int iso_lanczos_step(struct iso_lanczos *l) __attribute__((warn_unused_result));

#endif
