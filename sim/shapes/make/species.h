/* The kinds of creatures. */
#ifndef SIM_SHAPES_MAKE_SPECIES_H
#define SIM_SHAPES_MAKE_SPECIES_H

#include "sim/shapes/make/skeleton.h"

struct sim_species {
    const char *name;
    const struct sim_limb *limbs;
    int n_limbs;
};

enum { SIM_SPECIES = 12 };

extern const struct sim_species sim_species[SIM_SPECIES];

#endif
