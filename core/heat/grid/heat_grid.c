#include "core/heat/grid/heat_grid.h"

#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/heat/grid/chebyshev.h"
#include "core/heat/grid/grid_step.h"

enum { SOURCES_MAX = 64, WORKERS_MAX = 64 };

_Static_assert((int)ISO_HEAT_GRID_TIMES_MAX == (int)ISO_GRID_SUMS_MAX, "a sum for each time");
_Static_assert((int)SOURCES_MAX <= (int)ISO_TASKS_RACE_MAX, "sources are raced for");

/* How far an isotherm may move because the window ends, and because the expansion does: estimates
 * that count the worst of everything. Measured, it is a tenth of that (test_heat_grid_accuracy),
 * since most of what a window loses it loses all around, which the level makes good. */
static const double window_error_mm = 0.2, expansion_error_mm = 0.05;

/* Single precision leaves nothing below this. */
static const double tolerance_min = 1e-9;

/* Of t lambda: below, the coefficients' recurrence would overflow. */
static const double argument_min = 0.02;

/* A plane for each time, where a source's heat goes, and what it took. */
struct columns {
    struct iso_grid_window window; /* outside, they are 0 */
    struct iso_heat_grid_effort effort;
};

/* A source. Two workers may release its heat at the same time, each into columns of its own:
 * whoever is ready first leaves them here and takes those that were here for the next. */
struct flow {
    struct iso_grid_point source;
    struct iso_grid_window window;
    double lambda;      /* bound of the window's spectrum, 1/mm^2 */
    int before;         /* the columns of the call before */
    atomic_int columns; /* `before` until it is done */
};

/* What a worker needs: the recurrence's last two vectors, zero outside a running task. */
struct worker {
    float *vector[2];
    int columns;
    double c[ISO_HEAT_GRID_TIMES_MAX][ISO_CHEBYSHEV_TERMS_MAX];
};

struct iso_heat_grid {
    struct iso_heat_grid_options options;
    struct iso_grid_stencil *stencil;
    iso_grid_sweep *sweep;
    size_t plane_size, plane_origin;
    float *planes; /* those of the columns, then two for each worker */
    int n_columns; /* [n_sources + n_workers], as many to spare as there are workers */
    struct columns *columns;
    struct worker *workers;
    struct flow *flows;     /* [n_sources] */
    int order[SOURCES_MAX]; /* of the tasks: the longest first, so that workers end together */
    /* The last request, for whoever is still at it. */
    const struct iso_tasks *tasks;
    int n_sources, n_times;
    double pitch_mm, radius_mm, t_max_mm2, t_mm2[ISO_HEAT_GRID_TIMES_MAX];
};

static float *plane(const struct iso_heat_grid *h, int index)
{
    return h->planes + (size_t)index * h->plane_size + h->plane_origin;
}

static float *column_plane(const struct iso_heat_grid *h, int columns, int time)
{
    return plane(h, columns * h->options.n_times + time);
}

int iso_heat_grid_new(const struct iso_grid *grid, const struct iso_heat_grid_options *options,
                      struct iso_heat_grid **out)
{
    struct iso_heat_grid_options o = *options;
    o.n_workers = o.n_workers ? o.n_workers : 1;
    if (o.n_sources < 1 || o.n_sources > SOURCES_MAX || o.n_times < 1 ||
        o.n_times > ISO_HEAT_GRID_TIMES_MAX || o.n_workers < 1 || o.n_workers > WORKERS_MAX) {
        return -EINVAL;
    }
    struct iso_heat_grid *h = calloc(1, sizeof *h);
    if (!h) {
        return -ENOMEM;
    }
    h->options = o;
    h->sweep = iso_grid_stepper().sweep;
    h->plane_size = iso_grid_plane_size(grid);
    h->plane_origin = iso_grid_plane_origin(grid);
    h->n_columns = o.n_sources + o.n_workers;
    const int vectors = h->n_columns * o.n_times;
    h->planes = iso_grid_planes_new(grid, vectors + 2 * o.n_workers);
    h->columns = calloc((size_t)h->n_columns, sizeof *h->columns);
    h->workers = calloc((size_t)o.n_workers, sizeof *h->workers);
    h->flows = calloc((size_t)o.n_sources, sizeof *h->flows);
    int error = h->planes && h->columns && h->workers && h->flows ? 0 : -ENOMEM;
    error = error ? error : iso_grid_stencil_new(grid, &h->stencil);
    if (error) {
        iso_heat_grid_free(h);
        return error;
    }
    for (int w = 0; w < o.n_workers; w++) {
        h->workers[w].vector[0] = plane(h, vectors + 2 * w);
        h->workers[w].vector[1] = plane(h, vectors + 2 * w + 1);
        h->workers[w].columns = o.n_sources + w;
    }
    for (int s = 0; s < o.n_sources; s++) {
        atomic_init(&h->flows[s].columns, s);
    }
    *out = h;
    return 0;
}

void iso_heat_grid_free(struct iso_heat_grid *solver)
{
    if (solver) {
        struct iso_heat_grid *h = solver;
        iso_tasks_settle(h->tasks);
        const int planes = h->n_columns * h->options.n_times + 2 * h->options.n_workers;
        iso_grid_planes_free(h->planes, h->plane_size, planes);
        iso_grid_stencil_free(h->stencil);
        free(h->columns);
        free(h->workers);
        free(h->flows);
        free(h);
    }
}

/* The half side of the window, such that exp(-R (R - r) / t) <= window_error_mm r / 2t: the right
 * side is the relative change of heat along that way, for u ~ exp(-r^2 / 4t). */
static double reach_mm(double radius_mm, double t_mm2)
{
    double exponent = fmax(log(2.0 * t_mm2 / (radius_mm * window_error_mm)), 1.0);
    return 0.5 * radius_mm + sqrt(0.25 * radius_mm * radius_mm + t_mm2 * exponent);
}

/* Likewise the coefficients that may be left out: the heat at the radius in terms of a unit vector,
 * D^1/2 u, is pitch exp(-r^2 / 4t) / (4 pi t), that at the source 1 / pitch. */
static double tolerance_of(double pitch_mm, double radius_mm, double t_mm2)
{
    double level = exp(-radius_mm * radius_mm / (4.0 * t_mm2)) / (4.0 * M_PI * t_mm2);
    double share = expansion_error_mm * radius_mm / (2.0 * t_mm2);
    return fmax(pitch_mm * pitch_mm * level * share, tolerance_min);
}

static int clamp(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}

static int round_up(int value)
{
    return (value + ISO_LANES - 1) / ISO_LANES * ISO_LANES;
}

/* The pixels from (column, row) to (column_end, row_end), clipped to a window and widened to whole
 * groups of lanes counted from the window's left. */
static struct iso_grid_window clip(struct iso_grid_window in, int column, int row, int column_end,
                                   int row_end)
{
    int left = clamp(column - in.column, 0, in.width) / ISO_LANES * ISO_LANES;
    int right = round_up(clamp(column_end - in.column, 0, in.width));
    int top = clamp(row, in.row, in.row + in.height);
    int bottom = clamp(row_end, in.row, in.row + in.height);
    return (struct iso_grid_window){in.column + left, top, right - left, bottom - top};
}

/* The window of a source: its columns in whole groups of lanes, which may take it into the margin
 * to the right of the grid, where nothing is. */
static struct iso_grid_window window_of(const struct iso_grid *grid,
                                        const struct iso_grid_point *source, double reach)
{
    int px = (int)ceil(fmin(reach / grid->pitch_mm, grid->width + grid->height));
    int row = source->corner[0] / grid->stride, column = source->corner[0] % grid->stride;
    struct iso_grid_window w = {.column = clamp(column - px, 0, grid->width - 1) / ISO_LANES *
                                          ISO_LANES,
                                .row = clamp(row - px, 0, grid->height - 1)};
    w.width = round_up(clamp(column + px + 1, 1, grid->width) - w.column);
    w.height = clamp(row + px + 1, 1, grid->height) - w.row;
    return w;
}

/* The pixels that a source's heat can have reached after so many steps. */
static struct iso_grid_window reached(struct iso_grid_window window, int stride,
                                      const struct iso_grid_point *source, int steps)
{
    int left = INT32_MAX, right = 0, top = INT32_MAX, bottom = 0;
    for (int k = 0; k < 3; k++) {
        int row = source->corner[k] / stride, column = source->corner[k] % stride;
        left = column < left ? column : left;
        right = column > right ? column : right;
        top = row < top ? row : top;
        bottom = row > bottom ? row : bottom;
    }
    return clip(window, left - steps, top - steps, right + steps + 1, bottom + steps + 1);
}

static void clear(float *plane, ptrdiff_t stride, struct iso_grid_window window)
{
    for (int row = window.row; row < window.row + window.height; row++) {
        memset(&plane[row * stride + window.column], 0, (size_t)window.width * sizeof *plane);
    }
}

/* What the tasks share that prepare a release. */
struct preparation {
    struct iso_heat_grid *h;
    const struct iso_grid *grid;
    struct iso_grid_window all; /* holds the sources' windows */
    int step;                   /* of the operator */
};

/* weight D^-1/2 b: the unit load of the source. */
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

static void add(const struct iso_grid_load *load, float *y)
{
    for (int k = 0; k < load->n; k++) {
        y[load->at[k]] += load->value[k];
    }
}

/* A recurrence under way: steps are put off until a sweep is full of them. */
struct recurrence {
    const struct iso_heat_grid *h;
    const struct flow *flow;
    struct iso_heat_grid_effort *effort;
    float *now, *before; /* its last two vectors */
    int n_steps;
    struct iso_grid_step step[ISO_GRID_STEPS_MAX];
};

static struct recurrence begin_recurrence(const struct iso_heat_grid *h,
                                          const struct worker *worker, const struct flow *flow,
                                          double weight, struct iso_heat_grid_effort *effort)
{
    struct recurrence r = {
        .h = h,
        .flow = flow,
        .effort = effort,
        .now = worker->vector[0],
        .before = worker->vector[1],
    };
    const struct iso_grid_load load = load_of(h, &flow->source, weight);
    add(&load, r.now);
    return r;
}

static void sweep(struct recurrence *r)
{
    if (r->n_steps > 0) {
        r->h->sweep(r->h->stencil, r->step, r->n_steps);
        r->n_steps = 0;
    }
}

/* The next vector, 2 x now - before, or half of the first term: x = 2 A / lambda - 1 maps the
 * spectrum to -1..1. `steps` many are taken with it. */
static struct iso_grid_step *take_step(struct recurrence *r, int steps, double half)
{
    if (r->n_steps == ISO_GRID_STEPS_MAX) {
        sweep(r);
    }
    struct iso_grid_step *step = &r->step[r->n_steps++];
    *step = (struct iso_grid_step){
        .window = reached(r->flow->window, (int)r->h->stencil->stride, &r->flow->source, steps),
        .forth = (float)(half * 4.0 / r->flow->lambda),
        .back = (float)(half * -2.0),
        .y = r->now,
        .io = r->before,
    };
    r->before = r->now;
    r->now = step->io;
    r->effort->steps++;
    r->effort->pixels += (double)step->window.width * (double)step->window.height;
    return step;
}

/* One time: Clenshaw's recurrence (1955) from the last term down, b_k = c_k v + 2 x b_{k+1} -
 * b_{k+2} and the sum c_0 v + x b_1 - b_2. Needs no sum on the way, and starts where the
 * coefficients are small, which keeps rounding small. Returns the vector that holds the sum. */
static float *expand_one(const struct iso_heat_grid *h, const struct worker *worker,
                         const struct flow *flow, int terms, struct iso_heat_grid_effort *effort)
{
    const double *c = worker->c[0];
    struct recurrence r = begin_recurrence(h, worker, flow, c[terms - 1], effort);
    for (int k = terms - 2; k >= 0; k--) {
        struct iso_grid_step *step = take_step(&r, terms - 1 - k, k == 0 ? 0.5 : 1.0);
        step->load = load_of(h, &flow->source, c[k]);
    }
    sweep(&r);
    return r.now;
}

/* Several times: the polynomials themselves, T_{k+1} = 2 x T_k - T_{k-1}, summed for each time in
 * its own plane. */
static void expand_several(const struct iso_heat_grid *h, const struct worker *worker,
                           const struct flow *flow, const int *terms, float **sum,
                           struct iso_heat_grid_effort *effort)
{
    int most = 0;
    struct recurrence r = begin_recurrence(h, worker, flow, 1.0, effort);
    for (int j = 0; j < h->n_times; j++) {
        const struct iso_grid_load load = load_of(h, &flow->source, worker->c[j][0]);
        add(&load, sum[j]);
        most = terms[j] > most ? terms[j] : most;
    }
    for (int k = 1; k < most; k++) {
        struct iso_grid_sums *sums = &take_step(&r, k, k == 1 ? 0.5 : 1.0)->sums;
        for (int j = 0; j < h->n_times; j++) {
            if (k < terms[j]) {
                sums->weight[sums->n] = (float)worker->c[j][k];
                sums->sum[sums->n++] = sum[j];
            }
        }
    }
    sweep(&r);
}

/* column = D^-1/2 y in the window; y and column may be the same. */
static void finish(const struct iso_heat_grid *h, struct iso_grid_window window, const float *y,
                   float *column)
{
    for (int row = window.row; row < window.row + window.height; row++) {
        ptrdiff_t from = row * h->stencil->stride + window.column;
        for (ptrdiff_t i = from; i < from + window.width; i++) {
            column[i] = h->stencil->root[i] * y[i];
        }
    }
}

static void release_one(void *shared, int task, int worker_number)
{
    struct iso_heat_grid *h = shared;
    struct worker *worker = &h->workers[worker_number];
    struct flow *flow = &h->flows[h->order[task]];
    int before = flow->before;
    if (atomic_load(&flow->columns) != before) {
        return; /* another was faster */
    }
    struct columns *own = &h->columns[worker->columns];
    int terms[ISO_HEAT_GRID_TIMES_MAX];
    float *columns[ISO_HEAT_GRID_TIMES_MAX];
    /* Here until it is done: another worker writes beside `own`. */
    struct iso_heat_grid_effort effort = {.stiffness_max = h->t_max_mm2 * flow->lambda};
    for (int j = 0; j < h->options.n_times; j++) {
        columns[j] = column_plane(h, worker->columns, j);
        clear(columns[j], h->stencil->stride, own->window);
    }
    own->window = flow->window;
    for (int j = 0; j < h->n_times; j++) {
        const double t = h->t_mm2[j], tolerance = tolerance_of(h->pitch_mm, h->radius_mm, t);
        terms[j] = iso_chebyshev_exp(0.5 * t * flow->lambda, tolerance, worker->c[j]);
    }
    if (h->n_times == 1) {
        const float *sum = expand_one(h, worker, flow, terms[0], &effort);
        finish(h, flow->window, sum, columns[0]);
    } else {
        expand_several(h, worker, flow, terms, columns, &effort);
        for (int j = 0; j < h->n_times; j++) {
            finish(h, flow->window, columns[j], columns[j]);
        }
    }
    own->effort = effort;
    clear(worker->vector[0], h->stencil->stride, flow->window);
    clear(worker->vector[1], h->stencil->stride, flow->window);
    if (atomic_compare_exchange_strong(&flow->columns, &before, worker->columns)) {
        worker->columns = before;
    }
}

/* A band of a step of the operator. */
static void prepare_band(void *shared, int band, int worker_number)
{
    const struct preparation *p = shared;
    (void)worker_number;
    iso_grid_stencil_build_band(p->h->stencil, p->grid, p->all, p->step, band);
}

static bool on_surface(const struct iso_grid *grid, const struct iso_grid_point *source)
{
    bool there = true;
    for (int k = 0; k < 3 && there; k++) {
        int32_t at = source->corner[k];
        there = at >= 0 && at < grid->height * grid->stride && grid->share_mm2[at] > 0.0f;
    }
    return there;
}

/* The smallest window that holds two; columns stay whole groups of lanes. */
static struct iso_grid_window join(struct iso_grid_window a, struct iso_grid_window b)
{
    int column = a.column < b.column ? a.column : b.column, row = a.row < b.row ? a.row : b.row;
    int a_end = a.column + a.width, b_end = b.column + b.width;
    int a_bottom = a.row + a.height, b_bottom = b.row + b.height;
    return (struct iso_grid_window){column, row, (a_end > b_end ? a_end : b_end) - column,
                                    (a_bottom > b_bottom ? a_bottom : b_bottom) - row};
}

/* What a source will take, in no unit: pixels, and the terms of the expansion. */
static double work_of(const struct flow *flow)
{
    return (double)flow->window.width * flow->window.height * sqrt(flow->lambda);
}

static void put_in_order(struct iso_heat_grid *h)
{
    for (int s = 0; s < h->n_sources; s++) {
        int at = s;
        for (; at > 0 && work_of(&h->flows[h->order[at - 1]]) < work_of(&h->flows[s]); at--) {
            h->order[at] = h->order[at - 1];
        }
        h->order[at] = s;
    }
}

static bool request_sane(const struct iso_heat_grid *h, const struct iso_grid *grid,
                         const struct iso_heat_grid_request *r)
{
    bool sane = r->n_sources >= 1 && r->n_sources <= h->options.n_sources && r->n_times >= 1 &&
                r->n_times <= h->options.n_times && r->radius_mm > 0.0 && isfinite(r->radius_mm) &&
                iso_grid_plane_size(grid) == h->plane_size && grid->stride == h->stencil->stride;
    for (int j = 0; sane && j < r->n_times; j++) {
        sane = r->t_mm2[j] > 0.0 && isfinite(r->t_mm2[j]);
    }
    for (int i = 0; sane && i < r->n_sources; i++) {
        sane = on_surface(grid, &r->sources[i]);
    }
    return sane;
}

int iso_heat_grid(struct iso_heat_grid *h, const struct iso_grid *grid,
                  const struct iso_heat_grid_request *request, const struct iso_tasks *tasks)
{
    if (!request_sane(h, grid, request) || (tasks && tasks->n_workers > h->options.n_workers)) {
        return -EINVAL;
    }
    iso_tasks_settle(h->tasks);
    h->tasks = tasks;
    h->pitch_mm = grid->pitch_mm;
    h->radius_mm = request->radius_mm;
    h->n_sources = request->n_sources;
    h->n_times = request->n_times;
    h->t_max_mm2 = 0.0;
    double t_min = INFINITY, reach = 0.0;
    for (int j = 0; j < request->n_times; j++) {
        const double t = request->t_mm2[j];
        h->t_mm2[j] = t;
        t_min = fmin(t_min, t);
        h->t_max_mm2 = fmax(h->t_max_mm2, t);
        reach = fmax(reach, reach_mm(request->radius_mm, t));
    }
    struct preparation p = {h, grid, window_of(grid, &request->sources[0], reach), 0};
    for (int s = 0; s < request->n_sources; s++) {
        struct flow *flow = &h->flows[s];
        flow->source = request->sources[s];
        flow->window = window_of(grid, &request->sources[s], reach);
        flow->before = flow->columns;
        p.all = join(p.all, flow->window);
    }
    for (; p.step < ISO_GRID_STENCIL_STEPS; p.step++) {
        iso_tasks_run(tasks, prepare_band, &p, ISO_GRID_STENCIL_BANDS);
    }
    for (int s = 0; s < request->n_sources; s++) {
        struct flow *flow = &h->flows[s];
        flow->lambda = fmax(iso_grid_stencil_bound(h->stencil, flow->window), argument_min / t_min);
        if (!(h->t_max_mm2 * flow->lambda <= ISO_HEAT_GRID_STIFFNESS_MAX)) {
            return -ERANGE;
        }
    }
    put_in_order(h);
    iso_tasks_race(tasks, release_one, h, request->n_sources);
    return 0;
}

struct iso_grid_field iso_heat_grid_column(const struct iso_heat_grid *h, int source, int time)
{
    const int columns = h->flows[source].columns;
    return (struct iso_grid_field){h->columns[columns].window, column_plane(h, columns, time)};
}

struct iso_heat_grid_effort iso_heat_grid_effort(const struct iso_heat_grid *h)
{
    struct iso_heat_grid_effort all = {0};
    for (int s = 0; s < h->n_sources; s++) {
        const struct iso_heat_grid_effort *one = &h->columns[h->flows[s].columns].effort;
        all.steps += one->steps;
        all.pixels += one->pixels;
        all.stiffness_max = fmax(all.stiffness_max, one->stiffness_max);
    }
    return all;
}
