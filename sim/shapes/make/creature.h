/* Creatures: triangle meshes of a skeleton's flesh, in any pose.
 *
 * The surface is polygonised at rest on a randomly placed grid, thinned to well-shaped triangles
 * and then bent by its bones. Each vertex follows the bones in proportion to their share of the
 * field there (linear blend skinning: Lewis, Cordner and Fong 2000). Two poses of one creature
 * have different triangles but nearly the same distances along the surface. */
#ifndef SIM_SHAPES_MAKE_CREATURE_H
#define SIM_SHAPES_MAKE_CREATURE_H

#include "isotherm/mesh.h"
#include "sim/shapes/make/skeleton.h"

struct sim_creature {
    struct iso_mesh *mesh;    /* closed; in its pose */
    struct iso_vec3 *rest_mm; /* [n_vertices] each vertex's position at rest, for texture */
};

struct sim_creature_options {
    int32_t n_vertices; /* 200 or more; the result has a few more if thinning has to stop early */
    double pose;        /* strength of bending: 0 is rest, 1 is usual for the species */
};

/* Polygonises on a grid in a random position drawn from `grid`, and bends the result into a random
 * pose drawn from `pose`. The same states give the same numbers. -EINVAL for options out of range
 * or a skeleton without surface, -ENOMEM. */
int sim_creature_new(const struct sim_skeleton *skeleton,
                     const struct sim_creature_options *options, struct sim_random *grid,
                     struct sim_random *pose, struct sim_creature **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_creature_free(struct sim_creature *creature);

#endif
