/* The flesh about a skeleton: a convolution surface (Bloomenthal and Shoemake 1991).
 *
 * Each bone spreads the kernel (1 - d^2 / R^2)^3, d < R (Wyvill, McPheeters and Wyvill 1986), along
 * its length; the integral is a polynomial. The surface is where the fields of all bones add up to
 * `sim_flesh_level`. The fields of two halves of a bone add up to that of the whole, so that joints
 * do not bulge, and a long bone alone has exactly its radius; a bone's end is thinner and rounded,
 * and neighbours melt together. A radius that varies along a bone is taken at the nearest point of
 * the bone. */
#ifndef SIM_SHAPES_MAKE_FLESH_H
#define SIM_SHAPES_MAKE_FLESH_H

#include "sim/shapes/make/skeleton.h"

/* The level of the surface: what a long bone's field is at its radius. */
extern const double sim_flesh_level;

/* How far beyond its axis a bone's field reaches, in its larger radius. */
extern const double sim_flesh_reach;

/* One bone's field at a point, >= 0. */
double sim_flesh_bone(const struct sim_bone *bone, struct iso_vec3 p_mm);

/* The sum over all bones. */
double sim_flesh_field(const struct sim_skeleton *skeleton, struct iso_vec3 p_mm);

/* Its gradient, 1/mm, by central differences. */
struct iso_vec3 sim_flesh_gradient(const struct sim_skeleton *skeleton, struct iso_vec3 p_mm);

#endif
