/* Multipath: light that reaches a pixel by way of another surface, and therefore late. */
#ifndef SIM_WORLD_SENSOR_MULTIPATH_H
#define SIM_WORLD_SENSOR_MULTIPATH_H

#include <stddef.h>

struct sim_multipath {
    double share;       /* of a hollow's depth that is added to the distance */
    double limit_mm;    /* greatest error */
    int radius_cells;   /* of the surroundings that reflect light into a pixel */
    double together_mm; /* surfaces farther apart in depth do not light each other */
};

enum { SIM_MULTIPATH_CELL_PX = 4 };

/* Fills error_mm[height][width], >= 0, for the true depths of a frame (0: no surface). How hollow a
 * place is, is the mean over its surroundings of its depth behind the middle of two opposite
 * points; points are taken every fourth pixel and the errors between them interpolated. A plane and
 * a bulge have no error; in a hollow the error rises smoothly to the limit. `cells` is another
 * plane. Places whose surroundings are cut off by an outline count what is left. */
void sim_multipath_errors(const struct sim_multipath *model, const float *depth_mm, int width,
                          int height, float *cells, float *error_mm);

#endif
