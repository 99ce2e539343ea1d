/* The basis that block Lanczos builds for isotherm/eigenpairs.h.
 *
 * A = (L + s B)^-1 B is self-adjoint in the inner product x' B y; its largest eigenvalues 1 /
 * (lambda + s) belong to the smallest lambda. The vectors of V are orthonormal in that product, and
 * T = V' B A V. All of A V lies in V, except for the part that comes from the last block of V; that
 * part is the next block, `pending`; after a restart this holds again from the next step on.
 *
 * Every new block is made orthogonal twice: first to the last two blocks of V, where all but
 * rounding errors of it lies, because T is block tridiagonal; then to all of V. The first one after
 * a restart is made orthogonal to all of V both times.
 *
 * Only V is stored, which is most of the memory. V' B w is computed as V' (B w): multiplying a
 * block by B costs less than reading V does. Vectors are in the order of the factor and stored in
 * panels of eight (panel.h), so that the factor, B and V are read once for eight vectors. */
#ifndef ISO_CORE_HEAT_LANCZOS_H
#define ISO_CORE_HEAT_LANCZOS_H

#include "core/heat/block.h"
#include "core/heat/factor.h"
#include "core/heat/panel.h"
#include "core/heat/permuted.h"

struct iso_lanczos {
    struct iso_ldl ldl; /* of L + s B; borrowed from the factor */
    const struct iso_block_ops *block_ops;
    const struct iso_panel_ops *panel_ops;
    struct iso_permuted *permuted;
    struct iso_rows mass; /* B, in `permuted` */
    int32_t *order;       /* [n]: the vertex of each row */
    int32_t n, block, capacity;
    int32_t size;     /* vectors of V to which A was applied; whole panels until V is all */
    int32_t last;     /* how many of these the last block had; right after a restart: all */
    int32_t pending;  /* vectors of the next block, which follow; 0 if V is the whole space */
    double *v;        /* V: panels for capacity + block vectors */
    double *bv;       /* panels for a block: B applied to the next block */
    double *bw;       /* the same size: B w, working memory */
    double *w;        /* the same size: working memory */
    double *t;        /* [capacity][capacity]: T by columns */
    double *coupling; /* [block][block]: column c has the coefficients, in the next block, of A
                         applied to vector c of the last one */
    /* eight rows for each pair of panels of V and w: working memory */
    double (*product)[ISO_PANEL];
    uint64_t random; /* state of the generator of random numbers */
};

/* Begins a basis with one block of random vectors. `factor` is that of L + s B; until the last step
 * it must stay as it is. `capacity` is the most vectors of V, at most the order of the matrices,
 * and `block` a multiple of ISO_PANEL. -ENOMEM, -EDOM; iso_lanczos_done is needed after an error as
 * well. */
int iso_lanczos_init(struct iso_lanczos *l, const struct iso_symmetric *mass,
                     const struct iso_factor *factor, int32_t block, int32_t capacity)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_lanczos_done(struct iso_lanczos *l);

/* Applies A to the pending block and makes the next one. -EDOM if something is not finite. */
int iso_lanczos_step(struct iso_lanczos *l) __attribute__((warn_unused_result));

/* Restarts the basis with `keep` of the eigenvectors of T, `vectors` [keep][size] with `values`
 * [keep] (thick restart: Wu and Simon, SIAM J. Matrix Anal. Appl. 22, 2000); `keep` is a multiple
 * of ISO_PANEL. The pending block, whole panels, stays the next one. What T has of them is
 * diagonal; the next step adds how that block is coupled to them. -ENOMEM. */
int iso_lanczos_restart(struct iso_lanczos *l, const double *vectors, const double *values,
                        int32_t keep) __attribute__((warn_unused_result));

/* Ends the basis: V becomes its first k vectors times `vectors` [k][size], and the rest of its
 * memory is given back. Only iso_lanczos_write and iso_lanczos_done may follow. -ENOMEM. */
int iso_lanczos_end(struct iso_lanczos *l, const double *vectors, int32_t k)
    __attribute__((warn_unused_result));

/* Writes the first k vectors of V to out [k][n]. The values of each are in the order of the mesh's
 * vertices, and not in that of the factor. */
void iso_lanczos_write(const struct iso_lanczos *l, int32_t k, double *out);

#endif
