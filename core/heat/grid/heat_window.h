/* The windows of a depth grid in which the heat of a source is computed. Internal to core/heat.
 *
 * The column and the width of a window are multiples of ISO_LANES (lanes.h), so that a window may
 * reach into the margin to the right of the grid, where no vertex is. */
#ifndef ISO_CORE_HEAT_GRID_HEAT_WINDOW_H
#define ISO_CORE_HEAT_GRID_HEAT_WINDOW_H

#include <stddef.h>

#include "core/surface/grid.h"

/* Half the side of the window that a source needs, mm, so that the end of the window does not move
 * the isotherm of this radius noticeably. */
double iso_heat_window_reach_mm(double radius_mm, double t_mm2);

/* The window about a source: everything within `reach_mm` of it, clipped to the grid. */
struct iso_grid_window iso_heat_window(const struct iso_grid *grid,
                                       const struct iso_grid_point *source, double reach_mm);

/* The part of a source's window that its heat can have reached after this many steps. */
struct iso_grid_window iso_heat_window_reached(struct iso_grid_window window, ptrdiff_t stride,
                                               const struct iso_grid_point *source, int steps);

/* The smallest window that holds both. */
struct iso_grid_window iso_heat_window_join(struct iso_grid_window a, struct iso_grid_window b);

#endif
