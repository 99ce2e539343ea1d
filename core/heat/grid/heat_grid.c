#include "core/heat/grid/heat_grid.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/grid/chebyshev.h"
#include "core/heat/grid/flush_to_zero.h"
#include "core/heat/grid/grid_step.h"
#include "core/heat/grid/heat_window.h"

enum { SOURCES_MAX = 64, VECTORS = 2 };

/* How far an isotherm may move because the expansion is cut off: an estimate of the worst case,
 * like the one for the end of the window (heat_window.c). */
static const double expansion_error_mm = 0.05;

/* A smaller tolerance has no effect in single precision. */
static const double tolerance_min = 1e-9;

/* The least t lambda: with a smaller one the recurrence of the coefficients would overflow. */
static const double argument_min = 0.02;

/* A source and its window. Its heat is in the plane of the same index. */
struct column {
    struct iso_grid_point source;
    struct iso_grid_window window; /* the plane is 0 outside of it */
    double lambda;                 /* bound of the eigenvalues in the window, 1/mm^2 */
};

struct iso_heat_grid {
    struct iso_grid_stencil *stencil;
    iso_grid_sweep *sweep;
    size_t plane_size, plane_origin;
    float *planes; /* one for each source, then the vectors of the recurrence */
    int n_columns; /* most sources of a call */
    struct column *columns;
    float *vector[VECTORS]; /* the last two vectors of the recurrence; zero outside a call */
    double c[ISO_CHEBYSHEV_TERMS_MAX]; /* the coefficients of the expansion */
    struct iso_heat_grid_effort effort;
};

static float *plane_of(const struct iso_heat_grid *h, int index)
{
    return h->planes + (size_t)index * h->plane_size + h->plane_origin;
}

int iso_heat_grid_new(const struct iso_grid *grid, int n_sources, struct iso_heat_grid **out)
{
    if (n_sources < 1 || n_sources > SOURCES_MAX) {
        return -EINVAL;
    }
    struct iso_heat_grid *h = calloc(1, sizeof *h);
    if (!h) {
        return -ENOMEM;
    }
    h->sweep = iso_grid_stepper().sweep;
    h->plane_size = iso_grid_plane_size(grid);
    h->plane_origin = iso_grid_plane_origin(grid);
    h->n_columns = n_sources;
    h->planes = iso_grid_planes_new(grid, n_sources + VECTORS);
    h->columns = calloc((size_t)n_sources, sizeof *h->columns);
    if (!h->planes || !h->columns || iso_grid_stencil_new(grid, &h->stencil)) {
        iso_heat_grid_free(h);
        return -ENOMEM;
    }
    for (int i = 0; i < VECTORS; i++) {
        h->vector[i] = plane_of(h, n_sources + i);
    }
    *out = h;
    return 0;
}

void iso_heat_grid_free(struct iso_heat_grid *solver)
{
    if (solver) {
        iso_grid_planes_free(solver->planes, solver->plane_size, solver->n_columns + VECTORS);
        iso_grid_stencil_free(solver->stencil);
        free(solver->columns);
        free(solver);
    }
}

/* The sum of the coefficients that may be left out. The scaled heat D^1/2 u is pitch
 * exp(-r^2 / 4t) / (4 pi t) at the radius r, for a load of 1 / pitch at the source. */
static double tolerance_of(double pitch_mm, double radius_mm, double t_mm2)
{
    const double level = exp(-radius_mm * radius_mm / (4.0 * t_mm2)) / (4.0 * M_PI * t_mm2);
    const double share = expansion_error_mm * radius_mm / (2.0 * t_mm2);
    return fmax(pitch_mm * pitch_mm * level * share, tolerance_min);
}

static void clear_window(float *plane, ptrdiff_t stride, struct iso_grid_window window)
{
    for (int row = window.row; row < window.row + window.height; row++) {
        memset(&plane[row * stride + window.column], 0, (size_t)window.width * sizeof *plane);
    }
}

/* weight D^-1/2 b, where b is the unit load of the source. */
static struct iso_grid_load load_of(const struct iso_heat_grid *h,
                                    const struct iso_grid_point *source, double weight)
{
    struct iso_grid_load load = {.n = 3};
    for (int k = 0; k < load.n; k++) {
        load.at[k] = source->corner[k];
        load.value[k] = (float)(weight * source->weight[k] * (double)h->stencil->root[load.at[k]]);
    }
    return load;
}

static void add_load(const struct iso_grid_load *load, float *y)
{
    for (int k = 0; k < load->n; k++) {
        y[load->at[k]] += load->value[k];
    }
}

/* A recurrence that is being computed. Its steps are collected until they fill a sweep. */
struct recurrence {
    struct iso_heat_grid *h;
    const struct column *column;
    float *now, *before; /* its last two vectors */
    int n_steps;
    struct iso_grid_step step[ISO_GRID_STEPS_MAX];
};

static void sweep_steps(struct recurrence *r)
{
    if (r->n_steps > 0) {
        r->h->sweep(r->h->stencil, r->step, r->n_steps);
        r->n_steps = 0;
    }
}

/* Adds the step to the next vector, half * 2 x now - before, where x = 2 A / lambda - 1 maps the
 * spectrum to -1..1. `number` is the number of that vector; the load is number 0. */
static struct iso_grid_step *add_step(struct recurrence *r, int number, double half)
{
    if (r->n_steps == ISO_GRID_STEPS_MAX) {
        sweep_steps(r);
    }
    const struct column *column = r->column;
    struct iso_grid_step *step = &r->step[r->n_steps++];
    *step = (struct iso_grid_step){
        .window = iso_heat_window_reached(column->window, r->h->stencil->stride, &column->source,
                                          number),
        .forth = (float)(half * 4.0 / column->lambda),
        .back = (float)(half * -2.0),
        .y = r->now,
        .io = r->before,
    };
    r->before = r->now;
    r->now = step->io;
    r->h->effort.steps++;
    r->h->effort.pixels += (double)step->window.width * (double)step->window.height;
    return step;
}

/* Clenshaw's recurrence (1955) from the last term down, b_k = c_k v + 2 x b_{k+1} - b_{k+2} and the
 * sum c_0 v + x b_1 - b_2. It needs no separate sum, and it starts where the coefficients are
 * small, which keeps rounding small. Returns the vector that holds the sum. */
static const float *expand_exponential(struct iso_heat_grid *h, const struct column *column,
                                       int terms)
{
    struct recurrence r = {.h = h, .column = column, .now = h->vector[0], .before = h->vector[1]};
    const struct iso_grid_load first = load_of(h, &column->source, h->c[terms - 1]);
    add_load(&first, r.now);
    for (int k = terms - 2; k >= 0; k--) {
        struct iso_grid_step *step = add_step(&r, terms - 1 - k, k == 0 ? 0.5 : 1.0);
        step->load = load_of(h, &column->source, h->c[k]);
    }
    sweep_steps(&r);
    return r.now;
}

/* heat = D^-1/2 y in the window. */
static void scale_by_root(const struct iso_heat_grid *h, struct iso_grid_window window,
                          const float *y, float *heat)
{
    for (int row = window.row; row < window.row + window.height; row++) {
        const ptrdiff_t from = row * h->stencil->stride + window.column;
        for (ptrdiff_t i = from; i < from + window.width; i++) {
            heat[i] = h->stencil->root[i] * y[i];
        }
    }
}

static void release_one(struct iso_heat_grid *h, int source, double t_mm2, double tolerance)
{
    const struct column *column = &h->columns[source];
    const int terms = iso_chebyshev_exp(0.5 * t_mm2 * column->lambda, tolerance, h->c);
    scale_by_root(h, column->window, expand_exponential(h, column, terms), plane_of(h, source));
    for (int i = 0; i < VECTORS; i++) {
        clear_window(h->vector[i], h->stencil->stride, column->window);
    }
}

static bool on_surface(const struct iso_grid *grid, const struct iso_grid_point *source)
{
    for (int k = 0; k < 3; k++) {
        const int32_t at = source->corner[k];
        if (at < 0 || at >= grid->height * grid->stride || !(grid->share_mm2[at] > 0.0f)) {
            return false;
        }
    }
    return true;
}

static bool is_positive(double value)
{
    return value > 0.0 && isfinite(value);
}

static bool request_sane(const struct iso_heat_grid *h, const struct iso_grid *grid,
                         const struct iso_heat_grid_request *r)
{
    if (r->n_sources < 1 || r->n_sources > h->n_columns || !is_positive(r->radius_mm) ||
        !is_positive(r->t_mm2) || iso_grid_plane_size(grid) != h->plane_size ||
        grid->stride != h->stencil->stride) {
        return false;
    }
    for (int i = 0; i < r->n_sources; i++) {
        if (!on_surface(grid, &r->sources[i])) {
            return false;
        }
    }
    return true;
}

/* Gives each source its window, and builds the operator where the windows are. */
static void build_operator(struct iso_heat_grid *h, const struct iso_grid *grid,
                           const struct iso_heat_grid_request *request)
{
    const double reach_mm = iso_heat_window_reach_mm(request->radius_mm, request->t_mm2);
    struct iso_grid_window all = iso_heat_window(grid, &request->sources[0], reach_mm);
    for (int s = 0; s < request->n_sources; s++) {
        struct column *column = &h->columns[s];
        clear_window(plane_of(h, s), h->stencil->stride, column->window);
        column->source = request->sources[s];
        column->window = iso_heat_window(grid, &request->sources[s], reach_mm);
        all = iso_heat_window_join(all, column->window);
    }
    iso_grid_stencil_build(h->stencil, grid, all);
}

int iso_heat_grid(struct iso_heat_grid *h, const struct iso_grid *grid,
                  const struct iso_heat_grid_request *request)
{
    if (!request_sane(h, grid, request)) {
        return -EINVAL;
    }
    build_operator(h, grid, request);
    h->effort = (struct iso_heat_grid_effort){0};
    for (int s = 0; s < request->n_sources; s++) {
        struct column *column = &h->columns[s];
        const double bound = iso_grid_stencil_bound(h->stencil, column->window);
        column->lambda = fmax(bound, argument_min / request->t_mm2);
        const double stiffness = request->t_mm2 * column->lambda;
        if (!(stiffness <= ISO_HEAT_GRID_STIFFNESS_MAX)) {
            return -ERANGE;
        }
        h->effort.stiffness_max = fmax(h->effort.stiffness_max, stiffness);
    }
    const double tolerance = tolerance_of(grid->pitch_mm, request->radius_mm, request->t_mm2);
    const unsigned before = iso_flush_to_zero_begin();
    for (int s = 0; s < request->n_sources; s++) {
        release_one(h, s, request->t_mm2, tolerance);
    }
    iso_flush_to_zero_end(before);
    return 0;
}

struct iso_grid_field iso_heat_grid_column(const struct iso_heat_grid *h, int source)
{
    return (struct iso_grid_field){h->columns[source].window, plane_of(h, source)};
}

struct iso_heat_grid_effort iso_heat_grid_effort(const struct iso_heat_grid *h)
{
    return h->effort;
}
