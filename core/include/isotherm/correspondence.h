/** @file
 * Distances on a shape, and which points of two shapes correspond.
 *
 * Distances are geodesics in heat (Crane, Weischedel and Wardetzky, "Geodesics in heat", ACM TOG
 * 32, 2013): heat flows from a vertex for a short time t, the square of the mean length of the
 * edges; its gradient, made a field of unit vectors, points away from the vertex; the distance is
 * the function whose gradient is nearest to that field. Two solves for each source.
 *
 * Corresponding points are found by functional maps (Ovsjanikov, Ben-Chen, Solomon, Butscher and
 * Guibas, ACM TOG 31, 2012), which ZoomOut refines (Melzi, Ren, Rodola, Sharma, Wonka and
 * Ovsjanikov, ACM TOG 38, 2019). A functional map C takes the coefficients of a function on the
 * shape `from` in its first k eigenfunctions to those of the same function on the shape `to`. C is
 * [k][k], row by row. A map of points gives for each vertex of `to` the vertex of `from` that
 * corresponds to it. */
#ifndef ISOTHERM_CORRESPONDENCE_H
#define ISOTHERM_CORRESPONDENCE_H

#include "isotherm/shape.h"

/** The solver of a shape: the two factorised matrices that every distance on it needs. */
struct iso_geodesic;

/** Factorises the matrices.
 *
 * @param shape  The shape; it is borrowed and has to stay until iso_geodesic_free().
 * @param out    Receives the solver, which one thread at a time may use; free it with
 *               iso_geodesic_free().
 * @return 0; -EDOM if a matrix cannot be factorised; -ENOMEM. */
int iso_geodesic_new(const struct iso_shape *shape, struct iso_geodesic **out)
    __attribute__((warn_unused_result));

/** Frees a solver.
 *
 * @param geodesic  The solver, or NULL. */
void iso_geodesic_free(struct iso_geodesic *geodesic);

/** Distances of all vertices from one.
 *
 * @param geodesic  The solver.
 * @param vertex    The vertex.
 * @param distance  [n_vertices]: receives the distances, in the unit of the mesh.
 * @return 0; -EINVAL for a vertex out of range; -ENOMEM. */
int iso_geodesic_distance(struct iso_geodesic *geodesic, int32_t vertex, double *distance)
    __attribute__((warn_unused_result));

/** Functions that both shapes have, such as signatures. They belong to the caller. */
struct iso_shared_functions {
    int n;              /**< How many functions. */
    const double *from; /**< [n_vertices][n]: on the shape `from`. */
    const double *to;   /**< [n_vertices][n]: on the shape `to`. */
};

/** Computes the map C with the least |C a - b|^2 + weight |C diag(lambda_from) - diag(lambda_to)
 * C|^2. The first term takes each function a on `from` to its function b on `to`; the second one
 * makes C commute with the Laplacians. Functions are scaled to norm 1, and eigenvalues are divided
 * by the largest one.
 *
 * @param from       The one shape.
 * @param to         The other shape.
 * @param k          Eigenfunctions, 1 up to the pairs that both shapes have.
 * @param functions  Functions that both shapes have.
 * @param weight     Of the second term, above 0.
 * @param c          [k][k]: receives the map.
 * @return 0; -EINVAL for k, n < 1 or the weight; -EDOM if there is no solution; -ENOMEM. */
int iso_functional_map_fit(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                           const struct iso_shared_functions *functions, double weight, double *c)
    __attribute__((warn_unused_result));

/** The map of points that is nearest to a functional map: for each vertex of `to` the vertex of
 * `from` whose eigenfunctions, taken over by C, are nearest.
 *
 * @param from   The one shape.
 * @param to     The other shape.
 * @param k      Eigenfunctions of the map.
 * @param c      [k][k]: the map.
 * @param point  [vertices of `to`]: receives vertices of `from`.
 * @return 0; -EINVAL for k; -ENOMEM. */
int iso_functional_map_points(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                              const double *c, int32_t *point) __attribute__((warn_unused_result));

/** The functional map of a map of points.
 *
 * @param from   The one shape.
 * @param to     The other shape.
 * @param k      Eigenfunctions of the map.
 * @param point  [vertices of `to`]: vertices of `from`.
 * @param c      [k][k]: receives the map.
 * @return 0; -EINVAL for k or a point out of range; -ENOMEM. */
int iso_functional_map_of(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                          const int32_t *point, double *c) __attribute__((warn_unused_result));

/** Refines a functional map by turning it into a map of points and back with more eigenfunctions
 * each time.
 *
 * @param from    The one shape.
 * @param to      The other shape.
 * @param k       Eigenfunctions of the map that is given.
 * @param c       [k][k]: the map.
 * @param step    Eigenfunctions that each round adds, at least 1.
 * @param k_last  Eigenfunctions of the last round, at least k.
 * @param point   [vertices of `to`]: receives the last map of points.
 * @return 0; -EINVAL for k, step or k_last; -ENOMEM. */
int iso_zoom_out(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                 const double *c, int32_t step, int32_t k_last, int32_t *point)
    __attribute__((warn_unused_result));

enum {
    ISO_MATCH_FUNCTIONS = 80, /**< Functions that iso_shape_match() fits the first map to. */
};

/** Options of iso_shape_match(). */
struct iso_match_options {
    int32_t first_pairs; /**< Eigenfunctions of the first functional map, at least 2. */
    int32_t step;        /**< Eigenfunctions that each round of ZoomOut adds, at least 1. */
    double weight;       /**< Of the commutator with the Laplacians, above 0. */
};

/** Finds corresponding points. A first functional map is fitted to 60 wave kernel signatures, whose
 * energies come from the eigenvalues of `from`, and to 20 heat kernel signatures. ZoomOut then
 * refines this map.
 *
 * @param from     The one shape.
 * @param to       The other shape.
 * @param options  The options; fewer first pairs are used if a shape has fewer.
 * @param point    [vertices of `to`]: receives vertices of `from`.
 * @param c        [k][k]: receives the functional map of these points; k is the smaller number of
 *                 pairs of the two shapes.
 * @return 0; -EINVAL for options out of range, and for a shape with fewer than two different
 *         eigenvalues above 0; -EDOM if there is no first map; -ENOMEM. */
int iso_shape_match(const struct iso_shape *from, const struct iso_shape *to,
                    const struct iso_match_options *options, int32_t *point, double *c)
    __attribute__((warn_unused_result));

#endif
