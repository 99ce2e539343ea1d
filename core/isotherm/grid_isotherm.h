/* Isotherms on a depth grid: what iso_isotherm_level and iso_tracer_run do on a mesh, on the planes
 * of core/surface/grid.h and within a window. Same definition, same curves in the same order; but
 * only triangles near the level are looked at more than once. The window's border counts as a
 * border of the surface. */
#ifndef ISO_CORE_ISOTHERM_GRID_ISOTHERM_H
#define ISO_CORE_ISOTHERM_GRID_ISOTHERM_H

#include "core/surface/grid.h"
#include "isotherm/isotherm_curve.h"

/* Workspace for grids of the given one's size. -ENOMEM. */
struct iso_grid_tracer;
int iso_grid_tracer_new(const struct iso_grid *grid, struct iso_grid_tracer **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_grid_tracer_free(struct iso_grid_tracer *tracer);

/* Finds the level of a field that encloses the area pi radius^2 and traces all its curves. Returns
 * their number and the level, or -ERANGE if the window's surface is smaller than that or the field
 * is 0 there. */
int iso_grid_tracer_run(struct iso_grid_tracer *tracer, const struct iso_grid *grid,
                        const struct iso_grid_field *field, double radius_mm, double *level)
    __attribute__((warn_unused_result));

/* The curves, for iso_tracer_curve and iso_tracer_enclosing; valid until the next run. */
const struct iso_tracer *iso_grid_tracer_curves(const struct iso_grid_tracer *tracer);

#endif
