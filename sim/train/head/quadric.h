/* Quadric error metrics (Garland and Heckbert 1997). */
#ifndef SIM_TRAIN_HEAD_QUADRIC_H
#define SIM_TRAIN_HEAD_QUADRIC_H

#include "isotherm/vec.h"

/* Sum of area-weighted squared distances to planes: p'Ap + 2 b'p + c, A symmetric. */
struct sim_quadric {
    double axx, axy, axz, ayy, ayz, azz, bx, by, bz, c, area_mm2;
};

/* Adds the squared distance from the plane through a point with the unit normal n. */
void sim_quadric_add_plane(struct sim_quadric *q, struct iso_vec3 n, struct iso_vec3 point,
                           double weight);

/* Adds another sum. */
void sim_quadric_add(struct sim_quadric *q, const struct sim_quadric *r);

/* The sum at a point. */
double sim_quadric_at(const struct sim_quadric *q, struct iso_vec3 p);

#endif
