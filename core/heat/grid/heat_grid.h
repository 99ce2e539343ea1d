/* Columns of the heat kernel on a depth grid: the fast way, for what a sensor sees of a face.
 *
 * exp(-t A), A = D^-1/2 L D^-1/2 (grid_stencil.h), is computed by its Chebyshev expansion over the
 * spectrum [0, lambda] of a window about each source (Tal-Ezer 1989), in single precision. No
 * matrix is factorised. The work is one pass over a window, which fits the processor's cache, for
 * each degree of the expansion; the degree is about 3 sqrt(t lambda). Time convention and units are
 * those of heat_kernel.h.
 *
 * A column is computed in a square about its source, beyond which it is 0. The border of the square
 * is cold. At the radius r this has the effect of a negative source at 2 R - r, where R is half the
 * side of the square: a relative error of exp(-R (R - r) / t). R is chosen so that the isotherm of
 * that radius moves by about 0.02 mm (heat_window.c). (A distance seen from the front is shorter
 * than the distance on the surface, so that the square reaches further than it must.)
 *
 * Slivers, triangles so sharp that their eigenvalue dominates, make the degree grow. Beyond
 * t lambda = ISO_HEAT_GRID_STIFFNESS_MAX the general solver (heat_kernel.h) is at least as good,
 * and this one returns -ERANGE. */
#ifndef ISO_CORE_HEAT_GRID_HEAT_GRID_H
#define ISO_CORE_HEAT_GRID_HEAT_GRID_H

#include "core/surface/grid.h"

#define ISO_HEAT_GRID_STIFFNESS_MAX 3500.0

/* A request for the heat columns of some sources. */
struct iso_heat_grid_request {
    const struct iso_grid_point *sources; /* [n_sources] */
    int n_sources;
    double t_mm2;     /* time of the heat */
    double radius_mm; /* the columns are accurate within this radius about their sources */
};

/* The work of a call. */
struct iso_heat_grid_effort {
    int steps;            /* products with A for all sources */
    double pixels;        /* pixels of all these products */
    double stiffness_max; /* the largest t lambda of a source */
};

/* The solver: planes for grids of the given one's size. */
struct iso_heat_grid;

/* Makes a solver. n_sources: most sources of a call, 1..64; -EINVAL for others. -ENOMEM. */
int iso_heat_grid_new(const struct iso_grid *grid, int n_sources, struct iso_heat_grid **out)
    __attribute__((warn_unused_result));

/* Wipes the planes and frees the solver. NULL is accepted. */
void iso_heat_grid_free(struct iso_heat_grid *solver);

/* Computes the heat columns of a request on the grid's surface. -EINVAL for no sources or more than
 * the solver was made for, a time or radius that is not above 0, a source with a corner that is no
 * vertex, or a grid of another size; -ERANGE if the surface is too stiff for the time. */
int iso_heat_grid(struct iso_heat_grid *solver, const struct iso_grid *grid,
                  const struct iso_heat_grid_request *request) __attribute__((warn_unused_result));

/* The column of a source, 1/mm^2, after a call that returned 0. It belongs to the solver and is
 * valid until the next call. */
struct iso_grid_field iso_heat_grid_column(const struct iso_heat_grid *solver, int source);

/* The work of the last call that returned 0. */
struct iso_heat_grid_effort iso_heat_grid_effort(const struct iso_heat_grid *solver);

#endif
