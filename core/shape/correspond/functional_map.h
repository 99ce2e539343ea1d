/* Finds which points of two non-rigid shapes correspond. It uses functional maps (Ovsjanikov,
 * Ben-Chen, Solomon, Butscher and Guibas, ACM TOG 31, 2012), and refines them by ZoomOut (Melzi,
 * Ren, Rodola, Sharma, Wonka and Ovsjanikov, ACM TOG 38, 2019).
 *
 * A functional map C takes the coefficients of a function on the shape `from` in its first k
 * eigenfunctions to those of the same function on the shape `to`. C is [k][k], row by row. A map of
 * points gives for each vertex of `to` the vertex of `from` that corresponds to it. */
#ifndef ISO_CORE_SHAPE_CORRESPOND_FUNCTIONAL_MAP_H
#define ISO_CORE_SHAPE_CORRESPOND_FUNCTIONAL_MAP_H

#include "isotherm/shape.h"

/* Functions that both shapes have: [n_vertices][n] each, such as signatures. */
struct iso_shared_functions {
    int n;
    const double *from, *to;
};

/* Computes the map C with the least |C a - b|^2 + weight |C diag(lambda_from) - diag(lambda_to)
 * C|^2. The first term takes each function a on `from` to its function b on `to`; the second one
 * makes C commute with the Laplacians. Functions are scaled to norm 1, and eigenvalues are divided
 * by the largest one. -EINVAL for k < 1 or more than either shape has pairs, n < 1 or a weight not
 * above 0; -EDOM if it has no solution; -ENOMEM. */
int iso_functional_map_fit(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                           const struct iso_shared_functions *functions, double weight, double *c)
    __attribute__((warn_unused_result));

/* The map of points [vertices of `to`] that is nearest to a functional map: for each vertex of `to`
 * the vertex of `from` whose eigenfunctions, taken over by C, are nearest. -EINVAL for k, -ENOMEM.
 */
int iso_functional_map_points(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                              const double *c, int32_t *point) __attribute__((warn_unused_result));

/* The functional map of a map of points: c [k][k]. -EINVAL for k or a point out of range, -ENOMEM.
 */
int iso_functional_map_of(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                          const int32_t *point, double *c) __attribute__((warn_unused_result));

/* Refines a map c [k][k] by turning it into a map of points and back with `step` pairs more, up to
 * k_last pairs, and writes the last map of points. -EINVAL for k, step < 1 or k_last; -ENOMEM. */
int iso_zoom_out(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                 const double *c, int32_t step, int32_t k_last, int32_t *point)
    __attribute__((warn_unused_result));

#endif
