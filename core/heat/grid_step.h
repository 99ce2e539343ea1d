/* One step of a three-term recurrence with the 9-point stencil: the inner loop of the grid heat
 * solver. Internal to core/heat.
 *
 * The same source is compiled for the least processor of the architecture and, on x86-64, for AVX2;
 * iso_grid_stepper chooses by what the machine has. Both do the same operations in the same order
 * (AVX2 without FMA), so that results are the same to the bit. */
#ifndef ISO_CORE_HEAT_GRID_STEP_H
#define ISO_CORE_HEAT_GRID_STEP_H

#include "core/heat/grid_stencil.h"

enum { ISO_GRID_SUMS_MAX = 8 };

/* Sums that are gathered along the way: sum[j] += weight[j] * the new values. */
struct iso_grid_sums {
    int n; /* 0..ISO_GRID_SUMS_MAX */
    float weight[ISO_GRID_SUMS_MAX];
    float *sum[ISO_GRID_SUMS_MAX]; /* planes */
};

/* io = forth * A y + back * y - io in a window whose width is a multiple of ISO_LANES. */
typedef void iso_grid_step(const struct iso_grid_stencil *a, struct iso_grid_window window,
                           float forth, float back, const float *y, float *io,
                           const struct iso_grid_sums *sums);

iso_grid_step iso__grid_step_baseline;
iso_grid_step iso__grid_step_avx2; /* x86-64 only */

/* The fastest that this machine can run, and its name. */
struct iso_grid_stepper {
    iso_grid_step *step;
    const char *name;
};
struct iso_grid_stepper iso_grid_stepper(void);

#endif
