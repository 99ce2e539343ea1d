/* Functions that measure a solid. */
#ifndef TESTS_SIM_WORLD_SOLID_MEASURE_H
#define TESTS_SIM_WORLD_SOLID_MEASURE_H

#include "sim/world/prop/solid.h"

/* Returns the volume in mm^3. It is positive if the triangles are counter-clockwise seen from
 * outside. */
double solid_volume(const struct sim_solid *solid);

/* Returns the area of the surface in mm^2. */
double solid_area(const struct sim_solid *solid);

/* The bounding box of a solid. */
struct solid_extent {
    struct iso_vec3 least, most;
};

struct solid_extent solid_extent(const struct sim_solid *solid);

#endif
