/* Coats of creatures: colours that are painted at rest and move with the skin. */
#ifndef SIM_SHAPES_MAKE_TEXTURE_H
#define SIM_SHAPES_MAKE_TEXTURE_H

#include "isotherm/shape.h"
#include "sim/base/random.h"

enum sim_texture {
    SIM_TEXTURE_STRIPES, /* dark bands across the body, over sand */
    SIM_TEXTURE_SPOTS,   /* dark rosettes over ochre */
    SIM_TEXTURE_PATCHES, /* large brown patches on white */
    SIM_TEXTURE_SHADED,  /* green back, pale belly */
    SIM_TEXTURE_MARBLED, /* blue veins on grey */
    SIM_TEXTURES
};

/* "stripes", ...; NULL outside the range. */
const char *sim_texture_name(enum sim_texture texture);

/* The colour at a point of a creature at rest (see skeleton.h). Another `key` moves the pattern. */
struct iso_colour sim_texture_colour(enum sim_texture texture, uint64_t key,
                                     struct iso_vec3 rest_mm);

#endif
