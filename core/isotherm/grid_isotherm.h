/* Isotherms on a depth grid: does on the planes of core/surface/grid.h, within a window, what
 * iso_isotherm_level and iso_tracer_run do on a mesh. The curves and their order are the same, but
 * only triangles near the level are visited more than once. The border of the window counts as a
 * border of the surface. */
#ifndef ISO_CORE_ISOTHERM_GRID_ISOTHERM_H
#define ISO_CORE_ISOTHERM_GRID_ISOTHERM_H

#include "core/surface/grid.h"
#include "isotherm/isotherm_curve.h"

/* The workspace for grids of one size. */
struct iso_grid_tracer;

/* Makes a workspace for grids of the size of `grid`. -ENOMEM. */
int iso_grid_tracer_new(const struct iso_grid *grid, struct iso_grid_tracer **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_grid_tracer_free(struct iso_grid_tracer *tracer);

/* Takes a field whose isotherms are wanted. Grid and field must last until the last run. */
void iso_grid_tracer_begin(struct iso_grid_tracer *tracer, const struct iso_grid *grid,
                           const struct iso_grid_field *field);

/* Finds the level of the field that encloses the area pi radius^2, and traces all curves of that
 * level. Returns their number and sets *level. Runs of a field from the largest radius down take
 * least time. -ERANGE if the surface in the window is smaller than that area, or if the field is 0
 * there. */
int iso_grid_tracer_run(struct iso_grid_tracer *tracer, double radius_mm, double *level)
    __attribute__((warn_unused_result));

/* The curves, for iso_tracer_curve and iso_tracer_enclosing; valid until the next run. */
const struct iso_tracer *iso_grid_tracer_curves(const struct iso_grid_tracer *tracer);

#endif
