/** @file
 * Columns of the heat kernel: the temperature everywhere after unit heat at a point has flowed for
 * a time t.
 *
 * TIME CONVENTION: every t of this library is that of dU/dt = -Delta U, with decay exp(-lambda t)
 * and the planar kernel exp(-r^2 / 4t) / (4 pi t), in mm^2. (The dissertation's 3.23 and 3.36 decay
 * by exp(-lambda t / 2): its t is twice ours.)
 *
 * K(., s, t) = sum_i exp(-lambda_i t) phi_i(.) phi_i(s): unit heat at the surface point s, which
 * need not be a vertex. Its unit is 1/mm^2; its integral over the surface, 1' B K, is 1 at every t.
 * There are two ways to compute it:
 *
 *  - Spectral: the first k eigenpairs, as in the dissertation (k = 100, eq. 6.1). The high
 *    frequencies are missing, so that the result is wrong (even negative) for small t.
 *  - Direct: one Cholesky factorisation of B + gamma L, and shift-invert Lanczos of dimension m for
 *    each source (van den Eshof and Hochbruck 2006; Moret and Novati 2004). One Krylov space serves
 *    any number of times. This is the default for general meshes. */
#ifndef ISOTHERM_HEAT_KERNEL_H
#define ISOTHERM_HEAT_KERNEL_H

#include <stdint.h>

#include "isotherm/eigenpairs.h"
#include "isotherm/mesh.h"
#include "isotherm/stiffness_mass.h"

/** Heat columns from eigenpairs.
 *
 * @param pairs      Eigenpairs of the mesh.
 * @param mesh       The mesh.
 * @param sources    [n_sources]: where unit heat is released.
 * @param n_sources  How many sources.
 * @param t_mm2      [n_times]: the times, mm^2.
 * @param n_times    How many times.
 * @param out        [n_sources][n_times][n]: receives the temperature at each vertex, 1/mm^2; n is
 *                   that of the pairs. */
void iso_heat_spectral(const struct iso_eigenpairs *pairs, const struct iso_mesh *mesh,
                       const struct iso_surface_point *sources, int n_sources, const double *t_mm2,
                       int n_times, double *out);

/** The direct solver: a workspace that is created once and used for every frame. */
struct iso_heat_direct;

enum {
    ISO_HEAT_KRYLOV_MAX = 32, /**< Largest Lanczos dimension. */
};

/** Options of the direct solver. */
struct iso_heat_direct_options {
    int32_t n_capacity;   /**< Largest order of the matrices. */
    int32_t nnz_capacity; /**< Most entries of a matrix. */
    int krylov;           /**< Lanczos dimension m; 0: the default, 9. */
    double gamma_over_t;  /**< Shift over the largest t; 0: the default, 0.15. */
};

/** Makes a direct solver.
 *
 * @param options  The options; they are copied.
 * @param out      Receives the solver; free it with iso_heat_direct_free().
 * @return 0; -EINVAL for options out of range; -ENOMEM. */
int iso_heat_direct_new(const struct iso_heat_direct_options *options, struct iso_heat_direct **out)
    __attribute__((warn_unused_result));

/** Frees a direct solver.
 *
 * @param solver  The solver, or NULL. */
void iso_heat_direct_free(struct iso_heat_direct *solver);

/** Heat columns by the direct solver. It keeps the symbolic analysis of the matrices from call to
 * call while their pattern stays the same. The second call with a pattern orders it anew, for
 * smaller factors, so that the last digits of its results may differ from those of the first call.
 *
 * @param solver     The solver; one thread at a time.
 * @param mesh       The mesh.
 * @param stiffness  L, from iso_stiffness_mass().
 * @param mass       B, from the same call.
 * @param sources    [n_sources]: where unit heat is released.
 * @param n_sources  How many sources.
 * @param t_mm2      [n_times]: the times, mm^2; each above 0.
 * @param n_times    How many times.
 * @param out        [n_sources][n_times][n_vertices]: receives the temperature, 1/mm^2.
 * @return 0; -EINVAL (sizes that do not fit, a time that is not above 0, a source whose triangle
 *         does not exist or whose weights are not finite); -ENOSPC over a capacity; -EDOM if
 *         B + gamma L cannot be factorised; -ENOMEM. */
int iso_heat_direct(struct iso_heat_direct *solver, const struct iso_mesh *mesh,
                    const struct iso_symmetric *stiffness, const struct iso_symmetric *mass,
                    const struct iso_surface_point *sources, int n_sources, const double *t_mm2,
                    int n_times, double *out) __attribute__((warn_unused_result));

#endif
