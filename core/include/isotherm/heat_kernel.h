/* Columns of the heat kernel: the temperature everywhere after unit heat at a point has flowed for
 * time t.
 *
 * TIME CONVENTION: every t of this project is that of dU/dt = -Delta U, decay exp(-lambda t),
 * planar kernel exp(-r^2 / 4t) / (4 pi t), in mm^2. (The dissertation's 3.23 and 3.36 decay by
 * exp(-lambda t / 2): its t is twice ours.)
 *
 * K(., s, t) = sum_i exp(-lambda_i t) phi_i(.) phi_i(s): unit heat at the surface point s, which
 * need not be a vertex (barycentric weights b: phi D phi' b). Units 1/mm^2; its integral 1' B K is
 * 1 at every t. Two ways to it:
 *
 *  - spectral: the first k eigenpairs, as in the dissertation (k = 100, eq. 6.1). Loses the
 *    high frequencies, so that it is wrong (even negative) for small t.
 *  - direct: one Cholesky factorisation of B + gamma L and shift-invert Lanczos of dimension m for
 * each source (van den Eshof and Hochbruck 2006; Moret and Novati 2004): any number of times from
 *    one Krylov space. For general meshes, the default.
 *
 * On a depth grid there is a third, faster one: heat_grid.h. */
#ifndef ISOTHERM_HEAT_KERNEL_H
#define ISOTHERM_HEAT_KERNEL_H

#include <stdint.h>

#include "isotherm/eigenpairs.h"
#include "isotherm/mesh.h"
#include "isotherm/stiffness_mass.h"

/* Spectral columns: out[(s * n_times + j) * n] for source s and time j, n = pairs->n. */
void iso_heat_spectral(const struct iso_eigenpairs *pairs, const struct iso_mesh *mesh,
                       const struct iso_surface_point *sources, int n_sources, const double *t_mm2,
                       int n_times, double *out);

/* The direct solver: a workspace that is created once and used for every frame. */
struct iso_heat_direct;

enum { ISO_HEAT_KRYLOV_MAX = 32 };

struct iso_heat_direct_options {
    int32_t n_capacity, nnz_capacity; /* largest matrix */
    int krylov;                       /* Lanczos dimension m; 0 = the default, 9 */
    double gamma_over_t;              /* shift over the largest t; 0 = the default, 0.15 */
};

/* -EINVAL, -ENOMEM. */
int iso_heat_direct_new(const struct iso_heat_direct_options *options, struct iso_heat_direct **out)
    __attribute__((warn_unused_result));
void iso_heat_direct_free(struct iso_heat_direct *solver);

/* Heat columns as for iso_heat_spectral. The symbolic analysis is kept from call to call while the
 * pattern stays the same. -EINVAL (sizes, t <= 0, a source in no triangle or nowhere in it),
 * -ENOSPC over a capacity, -EDOM if B + gamma L cannot be factorised, -ENOMEM. */
int iso_heat_direct(struct iso_heat_direct *solver, const struct iso_mesh *mesh,
                    const struct iso_symmetric *stiffness, const struct iso_symmetric *mass,
                    const struct iso_surface_point *sources, int n_sources, const double *t_mm2,
                    int n_times, double *out) __attribute__((warn_unused_result));

#endif
