/* Multipath: light that reaches a pixel by way of another surface, and therefore late. */
#ifndef SIM_WORLD_SENSOR_MULTIPATH_H
#define SIM_WORLD_SENSOR_MULTIPATH_H

#include <stddef.h>

struct sim_multipath {
    double share;       /* the share of a hollow's depth that is added to the distance */
    double limit_mm;    /* the greatest error */
    int radius_cells;   /* radius of the surroundings that reflect light into a pixel */
    double together_mm; /* surfaces farther apart in depth do not light each other */
};

enum { SIM_MULTIPATH_CELL_PX = 4 };

/* Computes error_mm[height][width], >= 0, from the true depths of a frame (0: no surface).
 *
 * The error depends on how hollow the surface is at a place. Each two opposite points of the
 * surroundings have a middle. The hollowness is how far the place lies behind these middles, on
 * average. Pairs with a point on another surface, or on none, are left out. The error is 0 on
 * planes and bulges, and in hollows it rises smoothly to the limit. It is computed at the centres
 * of cells of SIM_MULTIPATH_CELL_PX and interpolated between them. `cells` is working memory for a
 * value of each cell. */
void sim_multipath_errors(const struct sim_multipath *model, const float *depth_mm, int width,
                          int height, float *cells, float *error_mm);

#endif
