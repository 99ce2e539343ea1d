/* A picture printed on a sheet: flat or bent, visible in the infrared or not. */
#ifndef SIM_WORLD_PROP_PRINT_H
#define SIM_WORLD_PROP_PRINT_H

#include "sim/world/prop/solid.h"

/* A rectangle of paper (sim_solid_rectangle) with a picture of columns x rows albedos, rows from
 * the top; each pixel is two triangles. Pass NULL for dye ink, which is transparent to near
 * infrared and looks like plain paper; carbon ink such as toner is visible. -EINVAL for sizes
 * that are not positive, a negative radius, or more than 2000 columns or rows; -ENOMEM. */
int sim_print_new(double width_mm, double height_mm, double bend_radius_mm, const float *albedo,
                  int columns, int rows, struct sim_solid **out)
    __attribute__((warn_unused_result));

#endif
