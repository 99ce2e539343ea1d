/* How good a map of points is, for poses of one creature: the generator knows where each vertex is
 * on the creature at rest (`shapes generate --rest`). */
#ifndef SIM_SHAPES_MATCH_TRUTH_H
#define SIM_SHAPES_MATCH_TRUTH_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "isotherm/shape.h"

/* Reads DIRECTORY/rest/NAME.npy for a mesh DIRECTORY/NAME.off: where its vertices are at rest,
 * three numbers each. *rest is NULL if there is no such file or if it has not n_vertices rows; free
 * it with free(). Errors of reading it; each with a fault. */
int sim_rest_read(const char *mesh, int32_t n_vertices, float **rest, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Errors of points: geodesic distances on `from` between the point that the map gives and the true
 * one, in square roots of the area of `from` (as in Kim, Lipman and Funkhouser, SIGGRAPH 2011). */
struct sim_match_error {
    int32_t n;        /* points measured, evenly spread over the vertices */
    double mean;      /* of all points */
    double within[3]; /* shares of the points within 0.05, 0.1 and 0.25 */
};

/* Measures a map point [vertices of `to`] into `from` by the vertices' places at rest. `mirrored`:
 * the true points are those of the creature's mirror image (x turned to -x), since distances along
 * the surface do not tell left from right. -ENOMEM, errors of iso_geodesic_new. */
int sim_rest_measure(const struct iso_shape *from, const float *from_rest,
                     const struct iso_shape *to, const float *to_rest, const int32_t *point,
                     bool mirrored, struct sim_match_error *out)
    __attribute__((warn_unused_result));

#endif
