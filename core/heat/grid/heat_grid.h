/* Columns of the heat kernel on a depth grid: the fast way, for what a sensor sees of a face.
 *
 * exp(-t A), A = D^-1/2 L D^-1/2 (grid_stencil.h), by its Chebyshev expansion over the spectrum
 * [0, lambda] of a window about each source (Tal-Ezer 1989), in single precision. Nothing is
 * factorised: the degree, about 3 sqrt(t lambda), times a pass over a window that fits the
 * processor's cache is all the work. Time convention, units and sources as in heat_kernel.h.
 *
 * A column is computed in a square about its source, beyond which it is 0. The square's border is
 * cold, which is felt at radius r like a negative source at 2 R - r, a relative error of
 * exp(-R (R - r) / t), R the half side; R is chosen so that the isotherm of that radius stays
 * within 0.02 mm. (Seen from the front a way is shorter than on the surface, so that the square
 * reaches further than it must.)
 *
 * Slivers - triangles so sharp that their eigenvalue dominates - make the degree grow: beyond
 * t lambda = ISO_HEAT_GRID_STIFFNESS_MAX the general solver (heat_kernel.h) is at least as good and
 * this one declines. */
#ifndef ISO_CORE_HEAT_GRID_HEAT_GRID_H
#define ISO_CORE_HEAT_GRID_HEAT_GRID_H

#include "core/surface/grid.h"

#define ISO_HEAT_GRID_STIFFNESS_MAX 3500.0

/* What is asked for: the heat columns of some sources at a time, right out to a radius about each
 * source. */
struct iso_heat_grid_request {
    const struct iso_grid_point *sources;
    int n_sources;
    double t_mm2;
    double radius_mm;
};

/* The work of a call. */
struct iso_heat_grid_effort {
    int steps;            /* products with A, of all sources */
    double pixels;        /* that these worked on */
    double stiffness_max; /* the largest t lambda */
};

/* The solver: planes for grids of the given one's size. */
struct iso_heat_grid;

/* n_sources: most sources of a call, 1..64. -EINVAL if it is out of range, -ENOMEM. */
int iso_heat_grid_new(const struct iso_grid *grid, int n_sources, struct iso_heat_grid **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_heat_grid_free(struct iso_heat_grid *solver);

/* Releases heat on the grid's surface. -EINVAL for more sources than the solver was made for, a
 * time or radius <= 0, a source with a corner that is no vertex or a grid of another size; -ERANGE
 * if the surface is too stiff for the time. */
int iso_heat_grid(struct iso_heat_grid *solver, const struct iso_grid *grid,
                  const struct iso_heat_grid_request *request) __attribute__((warn_unused_result));

/* Of the last call that returned 0; valid until the next call. Columns in 1/mm^2. */
struct iso_grid_field iso_heat_grid_column(const struct iso_heat_grid *solver, int source);
struct iso_heat_grid_effort iso_heat_grid_effort(const struct iso_heat_grid *solver);

#endif
