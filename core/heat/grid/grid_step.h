/* Steps of a three-term recurrence with the 9-point stencil: the inner loop of the grid heat
 * solver. Internal to core/heat.
 *
 * A sweep takes several steps in one pass over the rows. Each step is two rows behind the previous
 * one, so that the values which it needs are still in the first-level cache. Every pixel has the
 * same operations as if one step were taken after the other, so that results are the same to the
 * bit.
 *
 * The same source is compiled for the instructions that every processor of the architecture has
 * and, on x86-64, once more for AVX2.
 * iso_grid_stepper chooses the fastest that the machine has. Both do the same operations in the
 * same order (AVX2 without FMA), so that their results are the same to the bit. (On arm64 the
 * compiler may join a product and a sum into one instruction; the tests show whether it did so
 * everywhere.) */
#ifndef ISO_CORE_HEAT_GRID_GRID_STEP_H
#define ISO_CORE_HEAT_GRID_GRID_STEP_H

#include "core/heat/grid/grid_stencil.h"

enum { ISO_GRID_STEPS_MAX = 4 };

/* What a step adds at single pixels of its window. */
struct iso_grid_load {
    int n; /* 0..3 */
    ptrdiff_t at[3];
    float value[3];
};

/* io = forth * A y + back * y - io + load in a window whose column and width are multiples of
 * ISO_LANES. y must be 0 in the column before the window. It must also be 0 in the row above the
 * window if this is the first row of the window that A was built for. */
struct iso_grid_step {
    struct iso_grid_window window;
    float forth, back;
    const float *y;
    float *io;
    struct iso_grid_load load;
};

/* Takes 1..ISO_GRID_STEPS_MAX steps, one after the other: the y of each is the io of the one before
 * it, and its io is the y of the one before it. */
typedef void iso_grid_sweep(const struct iso_grid_stencil *a, const struct iso_grid_step *steps,
                            int n_steps);

iso_grid_sweep iso__grid_sweep_baseline;
iso_grid_sweep iso__grid_sweep_avx2; /* x86-64 only */

/* The fastest that this machine can run, and its name. */
struct iso_grid_stepper {
    iso_grid_sweep *sweep;
    const char *name;
};
struct iso_grid_stepper iso_grid_stepper(void);

#endif
