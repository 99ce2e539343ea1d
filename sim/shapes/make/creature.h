/* Creatures: a skeleton's flesh as a triangle mesh, in any pose.
 *
 * The surface is polygonised at rest, on a grid that lies at random, thinned to well-shaped
 * triangles and then bent by its bones, each vertex going with the bones in the measure of their
 * share of the field there (linear blend skinning: Lewis, Cordner and Fong 2000). Two poses of one
 * creature have different triangles and nearly the same distances along the surface. */
#ifndef SIM_SHAPES_MAKE_CREATURE_H
#define SIM_SHAPES_MAKE_CREATURE_H

#include "isotherm/mesh.h"
#include "sim/shapes/make/skeleton.h"

struct sim_creature {
    struct iso_mesh *mesh;    /* closed; in its pose */
    struct iso_vec3 *rest_mm; /* [n_vertices] where each vertex is at rest, for texture */
};

struct sim_creature_options {
    int32_t n_vertices; /* 200 or more; a few more than these remain where thinning has to stop */
    double pose;        /* how far it bends: 0 is rest, 1 as its species does */
};

/* Polygonises on a grid that `grid` draws, poses as `pose` draws; the same states give the same
 * numbers. -EINVAL for options out
 * of range or a skeleton without surface, -ENOMEM. */
int sim_creature_new(const struct sim_skeleton *skeleton,
                     const struct sim_creature_options *options, struct sim_random *grid,
                     struct sim_random *pose, struct sim_creature **out)
    __attribute__((warn_unused_result));
void sim_creature_free(struct sim_creature *creature);

#endif
