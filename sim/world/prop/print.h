/* A picture printed on a sheet: flat or bent in depth, a picture in the infrared, or none. */
#ifndef SIM_WORLD_PROP_PRINT_H
#define SIM_WORLD_PROP_PRINT_H

#include "sim/world/prop/solid.h"

/* A rectangle as sim_solid_rectangle makes it, of paper, with a picture of columns x rows albedos,
 * rows from the top; two triangles a pixel. Ink of dyes is transparent to near infrared and leaves
 * plain paper: NULL; ink of carbon, as in toner, shows. -EINVAL for sizes that are not positive or
 * over 2000, -ENOMEM. */
int sim_print_new(double width_mm, double height_mm, double bend_radius_mm, const float *albedo,
                  int columns, int rows, struct sim_solid **out)
    __attribute__((warn_unused_result));

#endif
