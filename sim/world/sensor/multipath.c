#include "sim/world/sensor/multipath.h"

#include <math.h>

/* The depths of a frame, seen at the centres of cells of SIM_MULTIPATH_CELL_PX. */
struct grid {
    const float *depth_mm;
    int width, height, columns, rows;
};

/* 0 outside the frame and where there is no surface. */
static double depth_of_cell(const struct grid *grid, int column, int row)
{
    const int u = column * SIM_MULTIPATH_CELL_PX + SIM_MULTIPATH_CELL_PX / 2;
    const int v = row * SIM_MULTIPATH_CELL_PX + SIM_MULTIPATH_CELL_PX / 2;
    if (column < 0 || row < 0 || u >= grid->width || v >= grid->height) {
        return 0.0;
    }
    return (double)grid->depth_mm[(size_t)v * (size_t)grid->width + (size_t)u];
}

/* How far a cell lies behind the middle of two opposite cells, on average over the pairs in its
 * surroundings; 0 if there is no pair on the same surface. */
static double hollowness(const struct sim_multipath *model, const struct grid *grid, int column,
                         int row)
{
    const double z = depth_of_cell(grid, column, row);
    const int r = model->radius_cells;
    double sum = 0.0;
    int n = 0;
    for (int dv = 0; dv <= r && z > 0.0; dv++) {
        for (int du = -r; du <= r; du++) {
            const double one = depth_of_cell(grid, column + du, row + dv);
            const double other = depth_of_cell(grid, column - du, row - dv);
            if (fabs(one - z) < model->together_mm && fabs(other - z) < model->together_mm) {
                sum += z - 0.5 * (one + other);
                n++;
            }
        }
    }
    return n > 0 ? sum / n : 0.0;
}

static double at_cell(const struct grid *grid, const float *cells, int column, int row)
{
    const int c = column < 0 ? 0 : column < grid->columns ? column : grid->columns - 1;
    const int r = row < 0 ? 0 : row < grid->rows ? row : grid->rows - 1;
    return (double)cells[r * grid->columns + c];
}

/* The value between the four nearest centres of cells. */
static double interpolate(const struct grid *grid, const float *cells, int u, int v)
{
    const double x = (double)(u - SIM_MULTIPATH_CELL_PX / 2) / SIM_MULTIPATH_CELL_PX;
    const double y = (double)(v - SIM_MULTIPATH_CELL_PX / 2) / SIM_MULTIPATH_CELL_PX;
    const int c = (int)floor(x), r = (int)floor(y);
    const double fx = x - c, fy = y - r;
    const double upper = (1.0 - fx) * at_cell(grid, cells, c, r) +
                         fx * at_cell(grid, cells, c + 1, r);
    const double lower = (1.0 - fx) * at_cell(grid, cells, c, r + 1) +
                         fx * at_cell(grid, cells, c + 1, r + 1);
    return (1.0 - fy) * upper + fy * lower;
}

void sim_multipath_errors(const struct sim_multipath *model, const float *depth_mm, int width,
                          int height, float *cells, float *error_mm)
{
    const struct grid grid = {
        depth_mm,
        width,
        height,
        (width + SIM_MULTIPATH_CELL_PX - 1) / SIM_MULTIPATH_CELL_PX,
        (height + SIM_MULTIPATH_CELL_PX - 1) / SIM_MULTIPATH_CELL_PX,
    };
    for (int row = 0; row < grid.rows; row++) {
        for (int column = 0; column < grid.columns; column++) {
            const double hollow_mm = fmax(hollowness(model, &grid, column, row), 0.0);
            cells[row * grid.columns + column] =
                (float)(model->limit_mm * tanh(model->share * hollow_mm / model->limit_mm));
        }
    }
    for (int v = 0; v < height; v++) {
        for (int u = 0; u < width; u++) {
            error_mm[(size_t)v * (size_t)width + (size_t)u] = (float)interpolate(&grid, cells, u,
                                                                                 v);
        }
    }
}
