/* The heat operator on a depth grid: A = D^-1/2 L D^-1/2, L the stiffness of linear elements and D
 * the lumped mass (stiffness_mass.h), as planes of a symmetric 9-point stencil.
 *
 * In a cell's triangle with legs p along the row and p down the column seen from the front, over
 * which the height changes by a and b, twice the area is W = p sqrt(p^2 + a^2 + b^2), and the
 * cotangents are a b / W where the legs meet, (p^2 + a^2 - a b) / W at the far end of the row's leg
 * and (p^2 + b^2 - a b) / W at that of the column's. */
#ifndef ISO_CORE_HEAT_GRID_GRID_STENCIL_H
#define ISO_CORE_HEAT_GRID_GRID_STENCIL_H

#include <stddef.h>

#include "core/surface/grid.h"

/* Planes in the grid's layout; entry (i, j) of A stands at the pixel that comes first, row by row,
 * that of a rising diagonal at the cell's top left. Where there is no vertex, everything is 0. */
struct iso_grid_stencil {
    ptrdiff_t stride;
    float *centre;       /* a pixel with itself */
    float *east, *south; /* with the pixels to the right and below, */
    float *south_east;   /* and the one right of that; */
    float *south_west;   /* the pixel to the right with the one below */
    float *root;         /* D^-1/2 of the pixel, 1/mm; 0: no vertex */
    float *bound;        /* no triangle of the cells in this row and the next seven has a larger
                            eigenvalue; in rows 0, 8, 16 ... */
    float *memory;       /* of all planes */
    size_t plane_size;   /* floats */
};

/* Planes for grids of that size. -ENOMEM. */
int iso_grid_stencil_new(const struct iso_grid *grid, struct iso_grid_stencil **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_grid_stencil_free(struct iso_grid_stencil *stencil);

/* The operator of the grid's surface at the pixels of a window, whose column and width are
 * multiples of ISO_LANES (lanes.h). */
void iso_grid_stencil_build(struct iso_grid_stencil *stencil, const struct iso_grid *grid,
                            struct iso_grid_window window);

/* No eigenvalue of A restricted to a window exceeds this, 1/mm^2: the largest over single triangles
 * (Fried 1972) of the window and of the few rows that share its blocks of eight. That of a triangle
 * with cotangents of sum s and the mass A / 3 at each corner is 3 / A times (s + sqrt(s^2 - 3)) /
 * 2, which is taken too large: by 2 % where the surface lies flat in the grid, s = 2, and by no
 * more than a third, for an equilateral triangle. */
double iso_grid_stencil_bound(const struct iso_grid_stencil *stencil,
                              struct iso_grid_window window);

#endif
