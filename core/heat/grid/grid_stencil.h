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

/* Planes in the grid's layout. The entry of A for two pixels is stored at the pixel that comes
 * first row by row; only the entry of a rising diagonal is stored at the top left pixel of its
 * cell. Where there is no vertex, all planes are 0. */
struct iso_grid_stencil {
    ptrdiff_t stride;
    float *centre;       /* a pixel with itself */
    float *east, *south; /* a pixel with the pixel to the right, and with the pixel below */
    float *south_east;   /* a pixel with the pixel below and to the right */
    float *south_west;   /* the pixel to the right with the pixel below */
    float *root;         /* D^-1/2 of the pixel, 1/mm; 0: no vertex */
    float *bound;        /* in rows 0, 8, 16 ...: the largest eigenvalue of a triangle of this
                            column's cells in this row and the next seven, or a little more */
    float *memory;       /* the memory of all planes */
    size_t plane_size;   /* floats of a plane */
};

/* Makes planes for grids of the size of `grid`. -ENOMEM. */
int iso_grid_stencil_new(const struct iso_grid *grid, struct iso_grid_stencil **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_grid_stencil_free(struct iso_grid_stencil *stencil);

/* Builds the operator of the grid's surface at the pixels of a window. The column and the width of
 * the window are multiples of ISO_LANES (lanes.h). */
void iso_grid_stencil_build(struct iso_grid_stencil *stencil, const struct iso_grid *grid,
                            struct iso_grid_window window);

/* An upper bound of the eigenvalues of A restricted to a window, 1/mm^2. It is the largest
 * eigenvalue of a single triangle (Fried 1972) in the window and in the few rows that share its
 * blocks of eight. A triangle of the area F, whose cotangents have the sum s, has the eigenvalue 3
 * / F (s + sqrt(s^2 - 3)) / 2, with the mass F / 3 at each corner. The approximation used here is
 * larger by 2 % where the surface lies flat in the grid (s = 2), and by at most a third, for an
 * equilateral triangle. */
double iso_grid_stencil_bound(const struct iso_grid_stencil *stencil,
                              struct iso_grid_window window);

#endif
