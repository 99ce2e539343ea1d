/** @file
 * Functions of the vertices of a shape, made of its eigenpairs: heat kernel signatures, the wave
 * kernel signature, and the vertices where a function has an extremum (the critical points). And
 * the directions from which most is seen of a mesh.
 *
 * Signatures take the eigenpairs of any (weighted) operator: L and B of stiffness_mass.h. Times are
 * as in heat_kernel.h: in the square of the mesh's unit, with decay exp(-lambda t). These are
 * offline tools: their functions allocate memory at every call. */
#ifndef ISOTHERM_SIGNATURE_H
#define ISOTHERM_SIGNATURE_H

#include "isotherm/eigenpairs.h"
#include "isotherm/shape.h"

/** Heat kernel signature: the heat that is still at a vertex a time after unit heat was released
 * there, K(x, x, t) = sum_i exp(-lambda_i t) phi_i(x)^2 (Sun, Ovsjanikov and Guibas 2009;
 * Abdelrahman 2013, 3.38; of weighted pairs the W-HKS, 5.17 without the B).
 *
 * @param pairs    Eigenpairs of the shape.
 * @param first    The first pair of the sum: 0 for the whole kernel, 1 without its constant.
 * @param t        [n_times]: the times.
 * @param n_times  How many times.
 * @param out      [n][n_times]: receives a row of times for each vertex, in 1 / unit^2; n is that
 *                 of the pairs.
 * @return 0; -ENOMEM. */
int iso_heat_signature(const struct iso_eigenpairs *pairs, int32_t first, const double *t,
                       int n_times, double *out) __attribute__((warn_unused_result));

/** Heat mean signature: the heat that all other vertices have received from a vertex by a time,
 * divided by the number of vertices (Fang, Sun, Kim and Ramani 2011; Abdelrahman 2013, 3.39).
 *
 * @param pairs  Eigenpairs of the shape.
 * @param t      The time.
 * @param out    [n]: receives a value for each vertex, in 1 / unit^2.
 * @return 0; -ENOMEM. */
int iso_heat_mean_signature(const struct iso_eigenpairs *pairs, double t, double *out)
    __attribute__((warn_unused_result));

/** The heat at every vertex after unit heat was released at one vertex.
 *
 * @param pairs    Eigenpairs of the shape.
 * @param vertex   The vertex, 0..n - 1.
 * @param first    The first pair of the sum: 0 for the whole kernel, 1 without its constant.
 * @param t        [n_times]: the times.
 * @param n_times  How many times.
 * @param out      [n][n_times]: receives a row of times for each vertex, in 1 / unit^2.
 * @return 0; -ENOMEM. */
int iso_heat_from_vertex(const struct iso_eigenpairs *pairs, int32_t vertex, int32_t first,
                         const double *t, int n_times, double *out)
    __attribute__((warn_unused_result));

/** Times evenly spaced on a logarithmic scale.
 *
 * @param t_first  The first time, above 0.
 * @param t_last   The last time, above 0.
 * @param n        How many.
 * @param t        [n]: receives the times. */
void iso_heat_times(double t_first, double t_last, int n, double *t);

/** Times at which a change of scale is a shift (Abdelrahman 2013, 4.3): t = unit alpha^tau.
 *
 * @param unit       The time at tau = 0, above 0.
 * @param alpha      The base, above 0.
 * @param tau_first  The first tau.
 * @param tau_step   From one tau to the next.
 * @param n          How many.
 * @param t          [n]: receives the times. */
void iso_heat_times_alpha(double unit, double alpha, double tau_first, double tau_step, int n,
                          double *t);

/** Energies for iso_wave_signature(): evenly spaced between the logarithms of the first and the
 * last eigenvalue above 0, two spreads away from both ends.
 *
 * @param pairs   Eigenpairs of the shape.
 * @param n       How many energies, at least 2.
 * @param energy  [n]: receives the energies, which are logarithms of eigenvalues.
 * @param spread  Receives the standard deviation of the energies, which is seven of their steps.
 * @return 0; -EINVAL for n < 2 or for fewer than two different eigenvalues above 0; the outputs are
 *         then unchanged. */
int iso_wave_energies(const struct iso_eigenpairs *pairs, int n, double *energy, double *spread)
    __attribute__((warn_unused_result));

/** Wave kernel signature (Aubry, Schlickewei and Cremers, "The wave kernel signature: a quantum
 * mechanical approach to shape analysis", ICCV Workshops 2011): how likely a quantum particle whose
 * energy is about e is found at a vertex. It is the mean of phi_i(x)^2, weighted by
 * exp(-(e - log lambda_i)^2 / (2 spread^2)), without the trivial pair.
 *
 * @param pairs   Eigenpairs of the shape.
 * @param energy  [n]: the energies.
 * @param n       How many energies.
 * @param spread  Their standard deviation, above 0.
 * @param out     [n_vertices][n]: receives a row of energies for each vertex, in 1 / unit^2.
 * @return 0; -ENOMEM. */
int iso_wave_signature(const struct iso_eigenpairs *pairs, const double *energy, int n,
                       double spread, double *out) __attribute__((warn_unused_result));

/** Vertices where a function has an extremum over its two rings of neighbours, except near a
 * boundary. */
struct iso_critical_points {
    int32_t n;       /**< How many. */
    int32_t *vertex; /**< [n]: their numbers, by falling magnitude of the function. */
};

/** Finds the extrema of any function of the vertices. Of two equal values, that of the vertex with
 * the larger index counts as higher.
 *
 * @param shape     The shape.
 * @param function  [n_vertices]: the function, finite.
 * @param out       Receives the points, which may be none; free them with
 *                  iso_critical_points_done().
 * @return 0; -ENOMEM. */
int iso_shape_extrema(const struct iso_shape *shape, const double *function,
                      struct iso_critical_points *out) __attribute__((warn_unused_result));

/** The critical points of a shape: the extrema of its first non-trivial eigenfunction (Abdelrahman
 * 2013, section 4.1, after Reuter 2010). They lie at the tips of a shape: there are as many as
 * limbs, whatever the pose.
 *
 * @param shape  The shape.
 * @param out    Receives at least one point: if all extrema lie near the boundary, it is the vertex
 *               of the largest magnitude. Free them with iso_critical_points_done().
 * @return 0; -ENOMEM. */
int iso_shape_critical_points(const struct iso_shape *shape, struct iso_critical_points *out)
    __attribute__((warn_unused_result));

/** Frees what the struct holds, and empties it.
 *
 * @param points  The points. */
void iso_critical_points_done(struct iso_critical_points *points);

/** A direction from which a mesh is seen in parallel projection, and what is seen of it. With p_i
 * the share of the picture of the mesh that triangle i takes, and q_i its share of the area of the
 * surface: */
struct iso_shape_view {
    struct iso_vec3 direction; /**< From the mesh to the viewer, of unit length. */
    /** Viewpoint entropy -sum p_i log2 p_i, in bits (Vazquez, Feixas, Sbert and Heidrich,
     * "Viewpoint selection using viewpoint entropy", VMV 2001, without the background). It is large
     * if many triangles are seen, all of the same size. So it depends on how the surface is
     * divided. */
    double entropy;
    /** Viewpoint Kullback-Leibler divergence sum p_i log2 (p_i / q_i), in bits (Sbert, Plemenos,
     * Feixas and Gonzalez, "Viewpoint quality: measures and applications", Computational Aesthetics
     * 2005). It is small if the picture shows all parts by their area. Cutting triangles that are
     * wholly seen or wholly hidden into pieces does not change it, as long as the pieces are of
     * more than some pixels. Infinite if nothing is seen. */
    double divergence;
};

/** By which score a view is good. */
enum iso_view_score {
    ISO_VIEW_ENTROPY,    /**< A large entropy. */
    ISO_VIEW_DIVERGENCE, /**< A small divergence. */
};

/** Finds the best views of a mesh. 162 directions, which turn with the principal axes of the
 * surface, are looked at; the best one is improved in steps of 7 degrees to half a degree; then the
 * best one of those that are far enough from it, and so on. Areas are counted in a picture of 512 x
 * 512 pixels.
 *
 * @param mesh       The mesh. Triangles are seen from both sides.
 * @param score      Which views are good.
 * @param apart_rad  The least angle between two views, above 0 and below pi.
 * @param n          How many views, at least 1.
 * @param out        [n]: receives the views in the order in which they are found: a later one can
 *                   be a little better after its improvement.
 * @param n_found    Receives how many there are: fewer than n if there is no room for more.
 * @return 0; -EINVAL for numbers out of range, and for a mesh without area or one that
 *         iso_mesh_check() refuses; -EDOM if its axes cannot be computed; -ENOMEM. */
int iso_shape_views(const struct iso_mesh *mesh, enum iso_view_score score, double apart_rad, int n,
                    struct iso_shape_view *out, int *n_found) __attribute__((warn_unused_result));

/** The scores of one direction.
 *
 * @param mesh       The mesh, as for iso_shape_views().
 * @param direction  From the mesh to the viewer, of any length above 0.
 * @param out        Receives the scores, and the direction of unit length.
 * @return As iso_shape_views(). */
int iso_shape_view_of(const struct iso_mesh *mesh, struct iso_vec3 direction,
                      struct iso_shape_view *out) __attribute__((warn_unused_result));

#endif
