/* Synthetic people: their identity (weights of the head model) and the surface of their head.
 *
 * Face frame: x to the subject's left, y up, z out of the face, origin at the MEAN face's nose tip,
 * mm. */
#ifndef SIM_WORLD_FACE_PERSON_H
#define SIM_WORLD_FACE_PERSON_H

#include <stdint.h>

#include "isotherm/vec.h"
#include "sim/world/face/ict.h"

/* Each population is a separate stream of random numbers, so that no person belongs to two
 * populations. Any other name makes another population. */
#define SIM_POPULATION_TRAIN  "train"
#define SIM_POPULATION_TEST   "test"
#define SIM_POPULATION_STORED "stored"

enum { SIM_IDENTITY_MODES = 100, SIM_EXPRESSION_SHAPES_MAX = 64 };

struct sim_person {
    double identity[SIM_IDENTITY_MODES]; /* standard deviations */
    uint64_t key;                        /* seed of the person's other properties, e.g. hair */
};

/* Person number `index` of a population; weights ~ N(0, variance_scale). The same arguments give
 * the same person. variance_scale 1 is the model's own; 0.36 makes people who look alike. */
struct sim_person sim_person_draw(const char *population, uint64_t seed, uint32_t index,
                                  double variance_scale);

/* The mean person: every weight 0. */
struct sim_person sim_person_mean(void);

/* The head's surface in the face frame: mean + identity + expression. `expression` has
 * ict->n_expression weights, or is NULL for none; `vertices_mm` has room for ict->n_vertices. */
void sim_person_surface(const struct sim_ict *ict, const struct sim_person *person,
                        const double *expression, struct iso_vec3 *vertices_mm);

#endif
