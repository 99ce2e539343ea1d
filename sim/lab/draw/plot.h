/* Line plots as PNG files. */
#ifndef SIM_LAB_DRAW_PLOT_H
#define SIM_LAB_DRAW_PLOT_H

#include "core/base/fault.h"
#include "sim/lab/draw/scale.h"

enum sim_series_style {
    SIM_SERIES_LINE,
    SIM_SERIES_MARKED, /* with a dot at each point */
    SIM_SERIES_DASHED, /* thin and grey, for orientation */
    SIM_SERIES_FILLED, /* filled down to the x axis: histograms */
};

struct sim_series {
    const char *label; /* in the legend; NULL: not listed */
    enum sim_series_style style;
    size_t n;
    const double *x, *y; /* [n] */
};

enum sim_legend {
    SIM_LEGEND_LINE = 0, /* in one line above the axes' box */
    SIM_LEGEND_UPPER,    /* one line for each series, in the upper right corner of the box */
    SIM_LEGEND_LOWER,    /* the same in the lower right corner */
};

struct sim_plot {
    const char *title, *subtitle; /* the subtitle may be NULL */
    enum sim_legend legend;
    struct sim_axis x, y;
    size_t n_series;
    const struct sim_series *series;
};

/* Draws a PNG file of 900 x 640 pixels. -EIO if the file cannot be written, -ENOMEM; each with a
 * fault. */
int sim_plot_write(const struct sim_plot *plot, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
