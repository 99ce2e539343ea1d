/* Signatures of a vertex: values of the heat kernel from eigenpairs.
 *
 * All functions take the eigenpairs of any (weighted) operator: L and B of
 * isotherm/stiffness_mass.h. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_HEAT_SIGNATURE_H
#define ISO_CORE_SHAPE_DESCRIBE_HEAT_SIGNATURE_H

#include "isotherm/eigenpairs.h"

/* Heat kernel signature K(x, x, t) = sum_i exp(-lambda_i t) phi_i(x)^2 (Sun, Ovsjanikov and Guibas
 * 2009; Abdelrahman 2013, 3.38; of weighted pairs the W-HKS, 5.17 without the B), pairs from
 * `first` on: 0 for the whole kernel, 1 without its constant. out is [n][n_times]. -ENOMEM. */
int iso_heat_signature(const struct iso_eigenpairs *pairs, int32_t first, const double *t,
                       int n_times, double *out) __attribute__((warn_unused_result));

/* Heat mean signature (Fang, Sun, Kim and Ramani 2011; 3.39): the heat that all other vertices have
 * received from a vertex by time t, divided by the number of vertices; out is [n]. -ENOMEM. */
int iso_heat_mean_signature(const struct iso_eigenpairs *pairs, double t, double *out)
    __attribute__((warn_unused_result));

/* The heat at every vertex after unit heat was released at one vertex, from the pairs from `first`
 * on: out is [n][n_times]. -ENOMEM. */
int iso_heat_from_vertex(const struct iso_eigenpairs *pairs, int32_t vertex, int32_t first,
                         const double *t, int n_times, double *out)
    __attribute__((warn_unused_result));

/* n times, evenly on a logarithmic scale from t_first to t_last (both > 0). */
void iso_heat_times(double t_first, double t_last, int n, double *t);

/* t = unit alpha^tau, tau from tau_first by steps (Abdelrahman 2013, 4.3). */
void iso_heat_times_alpha(double unit, double alpha, double tau_first, double tau_step, int n,
                          double *t);

#endif
