#include "core/landmark/shape_fit.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/gram.h"
#include "core/base/wipe.h"
#include "core/landmark/shape_fitter.h"
#include "core/landmark/spread.h"

/* Vertices that the starts of a fit compare. */
enum { TRIAL_VERTICES = 320 };

/* The cost of a vertex without a measurement when starts are compared. */
static const double unmeasured_cost_mm2 = 15.0;
static const int chin_ibug = 8;

/* After LAG_STEPS of LAG_TRIALS steps a start is compared with the best of the earlier starts,
 * which have made all of them. The start is given up if its cost is higher by lag_mm2, and if the
 * cost of the best one is at most lag_best_mm2. Both bounds were measured with ten iterations, that
 * is with LAG_TRIALS steps of each start, on 2,025 fits of rendered faces, real faces and attacks:
 * 1,248 of the 4,050 later starts were given up. The start that became the best of its fit was
 * never given up; its cost was higher by 1.95 mm2 at most. With another number of steps the bounds
 * mean nothing, and no start is given up. */
enum { LAG_STEPS = 3, LAG_TRIALS = 5 };
static const double lag_mm2 = 2.25, lag_best_mm2 = 3.5;

/* How far the jaw is open at the starts of a fit, in standard deviations of the first expression
 * mode, which is the jaw's. A start with the mouth shut does not find a mouth that is wide open. */
static const double jaw_starts[ISO_SHAPE_FIT_JAWS_MAX] = {0.0, 3.0, 6.0};

static bool options_sane(const struct iso_shape_fit_options *o)
{
    return o->rigid_iterations >= 1 && o->rigid_iterations <= 64 && o->iterations >= 1 &&
           o->iterations <= 64 && o->jaws >= 1 && o->jaws <= ISO_SHAPE_FIT_JAWS_MAX &&
           o->cutoff_last_mm > 0.0 && o->cutoff_first_mm >= o->cutoff_last_mm &&
           isfinite(o->cutoff_first_mm) && o->soft_weight >= 0.0 && o->soft_weight <= 1.0 &&
           o->identity_stiffness_mm2 > 0.0 && o->expression_stiffness_mm2 > 0.0;
}

/* The sign of the first expression mode that moves the chin down; 0 without such a mode. */
static double jaw_sign(const struct iso_head_model *model)
{
    if (model->n_expression == 0) {
        return 0.0;
    }
    const uint32_t chin = model->triangles[model->landmarks[chin_ibug].triangle][0];
    return model->expression_mm[3 * (size_t)chin + 1] > 0.0f ? -1.0 : 1.0;
}

/* Steps after which the starts are compared. */
static int trial_steps(const struct iso_shape_fit_options *options)
{
    return (options->iterations + 1) / 2;
}

/* Stores the modes of the model vertex by vertex, the order in which a step reads them. */
static void gather_modes(struct iso_shape_fitter *f)
{
    for (int k = 0; k < f->n_modes; k++) {
        const float *mode = iso__shape_mode(f->model, (uint32_t)k);
        for (uint32_t i = 0; i < f->model->n_vertices; i++) {
            for (int axis = 0; axis < 3; axis++) {
                float *at = iso__shape_modes_at(f, i) + iso_shape_mode_at(k);
                at[axis * ISO_GRAM_LANES] = mode[3 * (size_t)i + (size_t)axis];
            }
        }
    }
}

/* Allocates memory that begins at a line of the cache. aligned_alloc requires a size of whole
 * lines. NULL without memory. */
static float *alloc_lines(size_t bytes)
{
    return aligned_alloc(ISO_GRAM_LINE,
                         (bytes + ISO_GRAM_LINE - 1) / ISO_GRAM_LINE * ISO_GRAM_LINE);
}

static int allocate_planes(struct iso_shape_fitter *f)
{
    const size_t n = f->model->n_vertices;
    const size_t modes = iso_shape_modes_floats(n, f->mode_stride) * sizeof *f->modes;
    const size_t rows = n * (size_t)iso_gram_stride(ISO__SHAPE_UNKNOWNS_MAX + 1) * sizeof *f->rows;
    f->modes = alloc_lines(modes);
    f->rows = alloc_lines(rows);
    f->vertex = calloc(n, sizeof *f->vertex);
    f->place = calloc(n, sizeof *f->place);
    f->triangle = calloc(f->model->n_triangles, sizeof *f->triangle);
    f->start_mm = calloc(2 * n * (size_t)f->options.jaws, sizeof *f->start_mm);
    f->shape = calloc(n, sizeof *f->shape);
    f->normal = calloc(n, sizeof *f->normal);
    f->best_shape = calloc(n, sizeof *f->best_shape);
    f->best_normal = calloc(n, sizeof *f->best_normal);
    f->fitted = calloc(n, sizeof *f->fitted);
    f->residual_mm = calloc(n, sizeof *f->residual_mm);
    f->meeting = calloc(n, sizeof *f->meeting);
    f->gram = calloc((ISO__SHAPE_UNKNOWNS_MAX + 1) * (ISO__SHAPE_UNKNOWNS_MAX + 1),
                     sizeof *f->gram);
    f->h = calloc((size_t)ISO__SHAPE_UNKNOWNS_MAX * ISO__SHAPE_UNKNOWNS_MAX, sizeof *f->h);
    if (!f->modes || !f->rows || !f->vertex || !f->place || !f->triangle || !f->start_mm ||
        !f->shape || !f->normal || !f->best_shape || !f->best_normal || !f->fitted ||
        !f->residual_mm || !f->meeting || !f->gram || !f->h) {
        return -ENOMEM;
    }
    memset(f->modes, 0, modes);
    return 0;
}

/* Lists the triangles at compared vertices, and the vertices in the order of their modes. -ENOMEM.
 */
static int gather_near(struct iso_shape_fitter *f)
{
    enum { COMPARED = 1, NEAR = 2 };
    const struct iso_head_model *model = f->model;
    uint8_t *kind = calloc(model->n_vertices, sizeof *kind);
    if (!kind) {
        return -ENOMEM;
    }
    for (int i = 0; i < f->n_face; i++) {
        kind[f->vertex[i]] = COMPARED | NEAR;
    }
    for (uint32_t t = 0; t < model->n_triangles; t++) {
        const uint32_t *v = model->triangles[t];
        if ((kind[v[0]] | kind[v[1]] | kind[v[2]]) & COMPARED) {
            memcpy(f->triangle[f->n_triangles++], v, sizeof f->triangle[0]);
            for (int k = 0; k < 3; k++) {
                kind[v[k]] |= NEAR;
            }
        }
    }
    int n = f->n_face;
    for (int near = NEAR; near >= 0; near -= NEAR) {
        for (uint32_t i = 0; i < model->n_vertices; i++) {
            if (kind[i] == near) {
                f->vertex[n++] = i;
            }
        }
        f->n_near = near ? n : f->n_near;
    }
    for (int i = 0; i < n; i++) {
        f->place[f->vertex[i]] = (uint32_t)i;
    }
    free(kind);
    return 0;
}

/* Shape and normals of a start of the fit. */
static struct iso_vec3 *start_of(const struct iso_shape_fitter *f, int jaw)
{
    return &f->start_mm[2 * (size_t)jaw * f->model->n_vertices];
}

/* Sets a state to a start of the fit at a pose, without its shape and normals. */
static void begin_at(const struct iso_shape_fitter *f, int jaw, const struct iso_rigid *pose,
                     struct iso__shape_state *state)
{
    memset(state, 0, sizeof *state);
    state->pose = *pose;
    state->coefficient[f->model->n_identity] = jaw_starts[jaw] * f->jaw_sign;
}

/* Computes shape and normals of the starts, which are the same in each frame. */
static void prepare_starts(struct iso_shape_fitter *f)
{
    const size_t n = f->model->n_vertices;
    const struct iso_rigid pose = iso_rigid_identity();
    for (int jaw = 0; jaw < f->options.jaws; jaw++) {
        struct iso__shape_state state;
        begin_at(f, jaw, &pose, &state);
        iso__shape_set(f, &state);
        memcpy(start_of(f, jaw), f->shape, n * sizeof *f->shape);
        memcpy(start_of(f, jaw) + n, f->normal, n * sizeof *f->normal);
    }
}

/* Sets a state to a start of the fit at a pose, and shape and normals to its own. */
static void start_at(struct iso_shape_fitter *f, int jaw, const struct iso_rigid *pose,
                     struct iso__shape_state *state)
{
    const size_t n = f->model->n_vertices;
    begin_at(f, jaw, pose, state);
    memcpy(f->shape, start_of(f, jaw), n * sizeof *f->shape);
    memcpy(f->normal, start_of(f, jaw) + n, n * sizeof *f->normal);
}

int iso_shape_fitter_new(const struct iso_head_model *model,
                         const struct iso_shape_fit_options *options, struct iso_shape_fitter **out)
{
    if (!options_sane(options)) {
        return -EINVAL;
    }
    struct iso_shape_fitter *f = calloc(1, sizeof *f);
    if (!f) {
        return -ENOMEM;
    }
    f->model = model;
    f->options = *options;
    f->jaw_sign = jaw_sign(model);
    f->n_modes = (int)(model->n_identity + model->n_expression);
    f->mode_stride = iso_gram_stride(f->n_modes);
    int error = allocate_planes(f);
    if (!error) {
        const int most = options->vertices > 0 ? options->vertices : (int)model->n_vertices;
        error = iso_head_spread(model, most, f->vertex, &f->n_face);
    }
    if (!error && f->n_face < ISO__SHAPE_MEASURED_MIN) {
        error = -EINVAL;
    }
    if (!error) {
        error = gather_near(f);
    }
    if (error) {
        iso_shape_fitter_free(f);
        return error;
    }
    gather_modes(f);
    prepare_starts(f);
    *out = f;
    return 0;
}

void iso_shape_fitter_free(struct iso_shape_fitter *fitter)
{
    if (fitter) { /* the shape of the last face is biometric data */
        free(fitter->modes);
        iso_wipe_free(fitter->rows);
        free(fitter->vertex);
        free(fitter->place);
        free(fitter->triangle);
        free(fitter->start_mm); /* of the model */
        iso_wipe_free(fitter->shape);
        iso_wipe_free(fitter->normal);
        iso_wipe_free(fitter->best_shape);
        iso_wipe_free(fitter->best_normal);
        iso_wipe_free(fitter->fitted);
        iso_wipe_free(fitter->residual_mm);
        iso_wipe_free(fitter->meeting);
        iso_wipe_free(fitter->gram);
        iso_wipe_free(fitter->h);
        free(fitter);
    }
}

struct iso_shape_residuals iso_shape_fitter_residuals(const struct iso_shape_fitter *fitter)
{
    return (struct iso_shape_residuals){fitter->model->n_vertices, fitter->fitted,
                                        fitter->residual_mm, fitter->meeting};
}

/* Tukey's cut-off falls geometrically from the first to the last of the steps. */
static double cutoff_at(const struct iso_shape_fit_options *o, int step, int steps)
{
    return o->cutoff_first_mm *
           pow(o->cutoff_last_mm / o->cutoff_first_mm, (double)step / fmax(steps - 1, 1));
}

/* Steps `from` to `to` of the fit with all modes. */
static int take_steps(struct iso_shape_fitter *f, const struct iso_frame *frame, int from, int to,
                      int n_vertices, struct iso__shape_state *state)
{
    int error = 0;
    for (int i = from; i < to && !error; i++) {
        const struct iso__shape_unknowns all = {n_vertices, ISO__SHAPE_POSE + f->n_modes,
                                                cutoff_at(&f->options, i, f->options.iterations)};
        error = iso__shape_step(f, frame, &all, state);
    }
    return error;
}

/* How badly a state fits. If the model's mouth is shut over an open one, vertices there have no
 * measurements; they must count as well. */
static double cost_of(struct iso_shape_fitter *f, const struct iso_frame *frame,
                      const struct iso__shape_state *state)
{
    struct iso_pose_fit fit;
    iso__shape_measure(f, frame, &state->pose, &fit);
    return fit.coverage * fit.cost_mm2 + (1.0 - fit.coverage) * unmeasured_cost_mm2;
}

/* Takes the first steps of the fit from a start. *cost_mm2 is how badly it fits then; INFINITY if
 * it is given up, because it lags behind another start that costs best_mm2. */
static int try_jaw(struct iso_shape_fitter *f, const struct iso_frame *frame,
                   const struct iso_rigid *pose, int jaw, double best_mm2,
                   struct iso__shape_state *state, double *cost_mm2)
{
    const int steps = trial_steps(&f->options), first = steps == LAG_TRIALS ? LAG_STEPS : steps;
    start_at(f, jaw, pose, state);
    int error = take_steps(f, frame, 0, first, TRIAL_VERTICES, state);
    if (!error && first < steps && best_mm2 <= lag_best_mm2 &&
        cost_of(f, frame, state) > best_mm2 + lag_mm2) {
        *cost_mm2 = INFINITY;
        f->given_up++;
        return 0;
    }
    if (!error) {
        error = take_steps(f, frame, first, steps, TRIAL_VERTICES, state);
    }
    if (!error) {
        *cost_mm2 = cost_of(f, frame, state);
    }
    return error;
}

/* Fits the pose alone, with the mean face. */
static int fit_rigidly(struct iso_shape_fitter *f, const struct iso_frame *frame,
                       struct iso__shape_state *state)
{
    const struct iso_shape_fit_options *o = &f->options;
    const struct iso__shape_unknowns pose = {TRIAL_VERTICES, ISO__SHAPE_POSE, o->cutoff_first_mm};
    int error = 0;
    for (int i = 0; i < o->rigid_iterations && !error; i++) {
        error = iso__shape_step(f, frame, &pose, state);
    }
    return error;
}

/* Exchanges shape and normals with those of the best start. */
static void exchange_best(struct iso_shape_fitter *f)
{
    struct iso_vec3 *shape = f->shape, *normal = f->normal;
    f->shape = f->best_shape;
    f->normal = f->best_normal;
    f->best_shape = shape;
    f->best_normal = normal;
}

/* Sets the state, with shape and normals, to the best of the starts from its pose. -ENODATA if no
 * start can be fitted. */
static int choose_jaw(struct iso_shape_fitter *f, const struct iso_frame *frame,
                      struct iso__shape_state *state)
{
    const struct iso_rigid pose = state->pose;
    double best_mm2 = INFINITY;
    f->given_up = 0;
    for (int k = 0; k < f->options.jaws; k++) {
        struct iso__shape_state trial;
        double cost_mm2;
        if (!try_jaw(f, frame, &pose, k, best_mm2, &trial, &cost_mm2) && cost_mm2 < best_mm2) {
            best_mm2 = cost_mm2;
            *state = trial;
            exchange_best(f);
        }
    }
    exchange_best(f);
    return isfinite(best_mm2) ? 0 : -ENODATA;
}

/* The last state of a fit that begins at a pose, with its shape and normals. */
static int fit_state(struct iso_shape_fitter *f, const struct iso_frame *frame,
                     const struct iso_rigid *start, struct iso__shape_state *state)
{
    const struct iso_shape_fit_options *o = &f->options;
    start_at(f, 0, start, state);
    int error = fit_rigidly(f, frame, state);
    if (!error) {
        error = choose_jaw(f, frame, state);
    }
    if (!error) {
        error = take_steps(f, frame, trial_steps(o), o->iterations, f->n_face, state);
    }
    return error;
}

int iso_shape_fit(struct iso_shape_fitter *f, const struct iso_frame *frame,
                  const struct iso_rigid *start, struct iso_shape_fit *out)
{
    struct iso__shape_state state;
    const int error = fit_state(f, frame, start, &state);
    if (!error) {
        iso__shape_report(f, frame, &state, out);
    }
    return error;
}

int iso_shape_fit_pose(struct iso_shape_fitter *f, const struct iso_frame *frame,
                       const struct iso_rigid *start, struct iso_pose_fit *out)
{
    struct iso__shape_state state;
    const int error = fit_state(f, frame, start, &state);
    if (!error) {
        iso__shape_measure(f, frame, &state.pose, out);
    }
    return error;
}
