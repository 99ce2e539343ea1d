/* The flesh around a skeleton: a convolution surface (Bloomenthal and Shoemake 1991).
 *
 * Each bone spreads the kernel (1 - d^2 / R^2)^3, d < R (Wyvill, McPheeters and Wyvill 1986),
 * along its length; the integral is a polynomial. On the surface the fields of all bones add up
 * to `sim_flesh_level`. The fields of two halves of a bone add up to the field of the whole, so
 * that joints do not bulge. A long bone alone has exactly its radius; the end of a bone is
 * thinner and rounded, and neighbours merge. A radius that varies along a bone is taken at the
 * nearest point of the bone. */
#ifndef SIM_SHAPES_MAKE_FLESH_H
#define SIM_SHAPES_MAKE_FLESH_H

#include "sim/shapes/make/skeleton.h"

/* The level of the surface: the field of a long bone at its radius. */
extern const double sim_flesh_level;

/* The reach of a bone's field from its axis, in units of the bone's radius. */
extern const double sim_flesh_reach;

/* The field of one bone at a point, >= 0. */
double sim_flesh_bone(const struct sim_bone *bone, struct iso_vec3 p_mm);

/* The sum of all bones' fields. */
double sim_flesh_field(const struct sim_skeleton *skeleton, struct iso_vec3 p_mm);

/* The gradient of this sum, 1/mm, by central differences. */
struct iso_vec3 sim_flesh_gradient(const struct sim_skeleton *skeleton, struct iso_vec3 p_mm);

#endif
