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
                iso__shape_modes_at(
                    f, i)[axis * f->mode_stride + k] = mode[3 * (size_t)i + (size_t)axis];
            }
        }
    }
}

static int allocate_planes(struct iso_shape_fitter *f)
{
    const size_t n = f->model->n_vertices;
    /* Both sizes are multiples of 16 bytes, as aligned_alloc requires. */
    const size_t modes = 3 * n * (size_t)f->mode_stride * sizeof *f->modes;
    const size_t rows = n * (size_t)iso_gram_stride(ISO__SHAPE_UNKNOWNS_MAX + 1) * sizeof *f->rows;
    f->modes = aligned_alloc(ISO_GRAM_ALIGNMENT, modes);
    f->rows = aligned_alloc(ISO_GRAM_ALIGNMENT, rows);
    f->face = calloc(n, sizeof *f->face);
    f->shape = calloc(n, sizeof *f->shape);
    f->normal = calloc(n, sizeof *f->normal);
    f->fitted = calloc(n, sizeof *f->fitted);
    f->residual_mm = calloc(n, sizeof *f->residual_mm);
    f->meeting = calloc(n, sizeof *f->meeting);
    f->gram = calloc((ISO__SHAPE_UNKNOWNS_MAX + 1) * (ISO__SHAPE_UNKNOWNS_MAX + 1),
                     sizeof *f->gram);
    f->h = calloc((size_t)ISO__SHAPE_UNKNOWNS_MAX * ISO__SHAPE_UNKNOWNS_MAX, sizeof *f->h);
    if (!f->modes || !f->rows || !f->face || !f->shape || !f->normal || !f->fitted ||
        !f->residual_mm || !f->meeting || !f->gram || !f->h) {
        return -ENOMEM;
    }
    memset(f->modes, 0, modes);
    return 0;
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
        gather_modes(f);
        const int most = options->vertices > 0 ? options->vertices : (int)model->n_vertices;
        error = iso_head_spread(model, most, f->face, &f->n_face);
    }
    if (!error && f->n_face < ISO__SHAPE_MEASURED_MIN) {
        error = -EINVAL;
    }
    if (error) {
        iso_shape_fitter_free(f);
        return error;
    }
    *out = f;
    return 0;
}

void iso_shape_fitter_free(struct iso_shape_fitter *fitter)
{
    if (fitter) { /* the shape of the last face is biometric data */
        free(fitter->modes);
        iso_wipe_free(fitter->rows);
        free(fitter->face);
        iso_wipe_free(fitter->shape);
        iso_wipe_free(fitter->normal);
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

/* Takes the first steps of the fit from a state whose jaw is open by `jaw`. *cost_mm2 is how badly
 * it fits then. */
static int try_jaw(struct iso_shape_fitter *f, const struct iso_frame *frame,
                   const struct iso_rigid *pose, double jaw, struct iso__shape_state *state,
                   double *cost_mm2)
{
    struct iso_pose_fit fit;
    memset(state, 0, sizeof *state);
    state->pose = *pose;
    state->coefficient[f->model->n_identity] = jaw * f->jaw_sign;
    iso__shape_set(f, state);
    const int error = take_steps(f, frame, 0, trial_steps(&f->options), TRIAL_VERTICES, state);
    if (!error) {
        iso__shape_measure(f, frame, &state->pose, &fit);
        /* If the model's mouth is shut over an open one, vertices there have no measurements. They
         * must count as well. */
        *cost_mm2 = fit.coverage * fit.cost_mm2 + (1.0 - fit.coverage) * unmeasured_cost_mm2;
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

/* Sets the state to the best of the starts from its pose. -ENODATA if no start can be fitted. */
static int choose_jaw(struct iso_shape_fitter *f, const struct iso_frame *frame,
                      struct iso__shape_state *state)
{
    const struct iso_rigid pose = state->pose;
    double best_mm2 = INFINITY;
    for (int k = 0; k < f->options.jaws; k++) {
        struct iso__shape_state trial;
        double cost_mm2;
        if (!try_jaw(f, frame, &pose, jaw_starts[k], &trial, &cost_mm2) && cost_mm2 < best_mm2) {
            best_mm2 = cost_mm2;
            *state = trial;
        }
    }
    return isfinite(best_mm2) ? 0 : -ENODATA;
}

int iso_shape_fit(struct iso_shape_fitter *f, const struct iso_frame *frame,
                  const struct iso_rigid *start, struct iso_shape_fit *out)
{
    const struct iso_shape_fit_options *o = &f->options;
    struct iso__shape_state state = {.pose = *start};
    iso__shape_set(f, &state);
    int error = fit_rigidly(f, frame, &state);
    if (!error) {
        error = choose_jaw(f, frame, &state);
    }
    if (!error) {
        iso__shape_set(f, &state);
        error = take_steps(f, frame, trial_steps(o), o->iterations, f->n_face, &state);
    }
    if (!error) {
        iso__shape_report(f, frame, &state, out);
    }
    return error;
}
