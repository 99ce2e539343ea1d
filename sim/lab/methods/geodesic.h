/* Lengths of shortest paths over a face. */
#ifndef SIM_LAB_METHODS_GEODESIC_H
#define SIM_LAB_METHODS_GEODESIC_H

#include "sim/lab/methods/scan.h"

struct sim_geodesic;

/* A workspace for faces on the given grid. -ENOMEM. */
int sim_geodesic_new(const struct sim_scan *face, struct sim_geodesic **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_geodesic_free(struct sim_geodesic *geodesic);

/* Computes the distances over the surface from one place to n others, mm, by Dijkstra's algorithm
 * (1959) on the grid. Steps lead to 32 neighbours: of the 7 x 7 square, the nearest in each
 * direction. In the plane a path is at most 1.4 % too long. Places are (x, y) in the face frame;
 * the surface is linear along a step. -ENODATA if a place has no surface or cannot be reached. */
int sim_geodesic_from(struct sim_geodesic *geodesic, const struct sim_scan *face,
                      struct iso_vec3 from, const struct iso_vec3 *to, int n, double *distance_mm)
    __attribute__((warn_unused_result));

#endif
