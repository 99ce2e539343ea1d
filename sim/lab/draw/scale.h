/* Axes of plots: positions of values and of ticks. */
#ifndef SIM_LAB_DRAW_SCALE_H
#define SIM_LAB_DRAW_SCALE_H

#include <stddef.h>

enum sim_scale {
    SIM_SCALE_LINEAR,
    SIM_SCALE_LOG,
    SIM_SCALE_NORMAL, /* of probabilities: proportional to the normal distribution's quantile, so
                         that normally distributed scores make a straight DET curve (Martin et al.
                         1997) */
};

struct sim_axis {
    const char *label;
    enum sim_scale scale;
    double from, to; /* from < to; > 0 on a log scale, inside (0, 1) on a normal one */
};

enum { SIM_TICKS_MAX = 32 };

struct sim_tick {
    double value;
    char label[16];
};

/* The quantile of the standard normal distribution, 0 < p < 1 (Wichura 1988, algorithm AS 241,
 * PPND7: relative error below 1e-7). */
double sim_normal_quantile(double p);

/* Position of a value: 0 at `from`, 1 at `to`; values outside are moved to the nearer end. */
double sim_axis_place(const struct sim_axis *axis, double value);

/* Writes the ticks inside the axis in rising order and returns their number. */
size_t sim_axis_ticks(const struct sim_axis *axis, struct sim_tick ticks[SIM_TICKS_MAX]);

#endif
