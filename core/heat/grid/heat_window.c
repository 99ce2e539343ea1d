#include "core/heat/grid/heat_window.h"

#include <math.h>
#include <stdint.h>

#include "core/base/lanes.h"

/* How far an isotherm may move because the window ends, if all effects add up. The measured error
 * is a tenth of it (test_heat_grid_accuracy): a window loses most of its heat evenly all around,
 * and the level of the isotherm compensates for that. */
static const double window_error_mm = 0.2;

/* The half side R such that exp(-R (R - r) / t) <= window_error_mm r / 2t. The right side is the
 * relative change of heat over that distance, for u ~ exp(-r^2 / 4t). */
double iso_heat_window_reach_mm(double radius_mm, double t_mm2)
{
    const double exponent = fmax(log(2.0 * t_mm2 / (radius_mm * window_error_mm)), 1.0);
    return 0.5 * radius_mm + sqrt(0.25 * radius_mm * radius_mm + t_mm2 * exponent);
}

static int clamp(int value, int low, int high)
{
    if (value < low) {
        return low;
    }
    return value > high ? high : value;
}

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

static int larger(int a, int b)
{
    return a > b ? a : b;
}

static int round_up(int value)
{
    return (value + ISO_LANES - 1) / ISO_LANES * ISO_LANES;
}

struct iso_grid_window iso_heat_window(const struct iso_grid *grid,
                                       const struct iso_grid_point *source, double reach_mm)
{
    const int px = (int)ceil(fmin(reach_mm / grid->pitch_mm, grid->width + grid->height));
    int row = source->corner[0] / grid->stride, column = source->corner[0] % grid->stride;
    struct iso_grid_window w = {.column = clamp(column - px, 0, grid->width - 1) / ISO_LANES *
                                          ISO_LANES,
                                .row = clamp(row - px, 0, grid->height - 1)};
    w.width = round_up(clamp(column + px + 1, 1, grid->width) - w.column);
    w.height = clamp(row + px + 1, 1, grid->height) - w.row;
    return w;
}

/* The pixels from (column, row) to (column_end, row_end), clipped to a window and widened to whole
 * groups of lanes counted from the window's left. */
static struct iso_grid_window clip(struct iso_grid_window in, int column, int row, int column_end,
                                   int row_end)
{
    const int left = clamp(column - in.column, 0, in.width) / ISO_LANES * ISO_LANES;
    const int right = round_up(clamp(column_end - in.column, 0, in.width));
    const int top = clamp(row, in.row, in.row + in.height);
    const int bottom = clamp(row_end, in.row, in.row + in.height);
    return (struct iso_grid_window){in.column + left, top, right - left, bottom - top};
}

struct iso_grid_window iso_heat_window_reached(struct iso_grid_window window, ptrdiff_t stride,
                                               const struct iso_grid_point *source, int steps)
{
    int left = INT32_MAX, right = 0, top = INT32_MAX, bottom = 0;
    for (int k = 0; k < 3; k++) {
        int row = source->corner[k] / (int)stride, column = source->corner[k] % (int)stride;
        left = smaller(left, column);
        right = larger(right, column);
        top = smaller(top, row);
        bottom = larger(bottom, row);
    }
    return clip(window, left - steps, top - steps, right + steps + 1, bottom + steps + 1);
}

struct iso_grid_window iso_heat_window_join(struct iso_grid_window a, struct iso_grid_window b)
{
    int column = smaller(a.column, b.column), row = smaller(a.row, b.row);
    const int end = larger(a.column + a.width, b.column + b.width);
    const int bottom = larger(a.row + a.height, b.row + b.height);
    return (struct iso_grid_window){column, row, end - column, bottom - row};
}
