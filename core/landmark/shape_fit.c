#include "core/landmark/shape_fit.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/gram.h"
#include "core/base/solve.h"
#include "core/landmark/normals.h"
#include "core/landmark/pose_tally.h"
#include "core/landmark/spread.h"

enum {
    POSE = 6,
    UNKNOWNS_MAX = POSE + ISO_HEAD_IDENTITY_MAX + ISO_HEAD_EXPRESSION_MAX,
    MEASURED_MIN = 100,
    TRIAL_VERTICES = 320, /* that the starts of a fit look at */
};

static const double unmeasured_cost_mm2 = 15.0;
static const int chin_ibug = 8;

/* Residuals of neighbouring vertices are alike (the model's own error is smooth), so that there are
 * fewer independent ones than vertices: measured, so that sigma_mm is about the true error. */
static const double correlated_vertices = 12.0;

/* How far the jaw is open at the starts of a fit, in standard deviations of the first expression
 * mode, which is the jaw's; a start with the mouth shut does not find one that is wide open. */
static const double jaw_starts[ISO_SHAPE_FIT_JAWS_MAX] = {0.0, 3.0, 6.0};

struct iso_shape_fitter {
    const struct iso_head_model *model;
    struct iso_shape_fit_options options;
    double jaw_sign; /* of the first expression mode when the chin goes down */
    int n_modes, mode_stride;
    float *modes; /* [n_vertices][3][mode_stride] what a vertex moves by, identity first */
    int n_face;
    uint32_t *face;         /* [n_face] vertices that are compared: any first few are spread well */
    struct iso_vec3 *shape; /* [n_vertices] the head as fitted so far, face frame */
    struct iso_vec3 *normal;
    struct iso_vec3 *fitted; /* [n_vertices] the last fit, its expression on */
    float *residual_mm;      /* [n_vertices] of the last fit */
    uint8_t *meeting;        /* [n_vertices] */
    float *rows;  /* [n_face][iso_gram_stride(UNKNOWNS_MAX + 1)] of the Jacobian, and residuals */
    double *gram; /* [UNKNOWNS_MAX + 1][UNKNOWNS_MAX + 1] of the rows */
    double *h;    /* [UNKNOWNS_MAX][UNKNOWNS_MAX] normal equations, lower triangle; their factor */
};

/* What a step works on. */
struct stride {
    int n_vertices, n; /* of the face; unknowns */
    double cutoff_mm;
};

/* The state of a fit. */
struct state {
    struct iso_rigid pose;
    double coefficient[ISO_HEAD_IDENTITY_MAX + ISO_HEAD_EXPRESSION_MAX]; /* identity first */
};

static bool options_sane(const struct iso_shape_fit_options *o)
{
    return o->rigid_iterations >= 1 && o->rigid_iterations <= 64 && o->iterations >= 1 &&
           o->iterations <= 64 && o->jaws >= 1 && o->jaws <= ISO_SHAPE_FIT_JAWS_MAX &&
           o->cutoff_last_mm > 0.0 && o->cutoff_first_mm >= o->cutoff_last_mm &&
           isfinite(o->cutoff_first_mm) && o->soft_weight >= 0.0 && o->soft_weight <= 1.0 &&
           o->identity_stiffness_mm2 > 0.0 && o->expression_stiffness_mm2 > 0.0;
}

static double jaw_sign(const struct iso_head_model *model)
{
    if (model->n_expression == 0) {
        return 0.0;
    }
    uint32_t chin = model->triangles[model->landmarks[chin_ibug].triangle][0];
    return model->expression_mm[3 * (size_t)chin + 1] > 0.0f ? -1.0 : 1.0;
}

/* Steps after which the starts are compared. */
static int trial_steps(const struct iso_shape_fit_options *options)
{
    return (options->iterations + 1) / 2;
}

/* Mode k, identity first, as [n_vertices][3]. */
static const float *mode_of(const struct iso_head_model *model, uint32_t k)
{
    size_t stride = 3 * (size_t)model->n_vertices;
    return k < model->n_identity ? &model->identity_mm[k * stride]
                                 : &model->expression_mm[(k - model->n_identity) * stride];
}

static float *modes_at(const struct iso_shape_fitter *f, uint32_t vertex)
{
    return &f->modes[3 * (size_t)f->mode_stride * vertex];
}

/* The model's modes, vertex by vertex: how they are used. */
static void gather_modes(struct iso_shape_fitter *f)
{
    for (int k = 0; k < f->n_modes; k++) {
        const float *mode = mode_of(f->model, (uint32_t)k);
        for (uint32_t i = 0; i < f->model->n_vertices; i++) {
            for (int axis = 0; axis < 3; axis++) {
                modes_at(f, i)[axis * f->mode_stride + k] = mode[3 * (size_t)i + (size_t)axis];
            }
        }
    }
}

static int allocate(struct iso_shape_fitter *f)
{
    size_t n = f->model->n_vertices;
    /* Both whole multiples of 16 bytes, as aligned_alloc wants it. */
    size_t modes = 3 * n * (size_t)f->mode_stride * sizeof *f->modes;
    size_t rows = n * (size_t)iso_gram_stride(UNKNOWNS_MAX + 1) * sizeof *f->rows;
    f->modes = aligned_alloc(ISO_GRAM_ALIGNMENT, modes);
    f->rows = aligned_alloc(ISO_GRAM_ALIGNMENT, rows);
    f->face = calloc(n, sizeof *f->face);
    f->shape = calloc(n, sizeof *f->shape);
    f->normal = calloc(n, sizeof *f->normal);
    f->fitted = calloc(n, sizeof *f->fitted);
    f->residual_mm = calloc(n, sizeof *f->residual_mm);
    f->meeting = calloc(n, sizeof *f->meeting);
    f->gram = calloc((UNKNOWNS_MAX + 1) * (UNKNOWNS_MAX + 1), sizeof *f->gram);
    f->h = calloc((size_t)UNKNOWNS_MAX * UNKNOWNS_MAX, sizeof *f->h);
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
    int error = allocate(f);
    if (!error) {
        gather_modes(f);
        int most = options->vertices > 0 ? options->vertices : (int)model->n_vertices;
        error = iso_head_spread(model, most, f->face, &f->n_face);
    }
    if (!error && f->n_face < MEASURED_MIN) {
        error = -EINVAL;
    }
    if (error) {
        iso_shape_fitter_free(f);
        return error;
    }
    *out = f;
    return 0;
}

static void wipe(struct iso_vec3 *points, size_t n)
{
    if (points) {
        explicit_bzero(points, n * sizeof *points);
    }
}

void iso_shape_fitter_free(struct iso_shape_fitter *fitter)
{
    if (fitter) { /* what is left of a face is biometric data */
        wipe(fitter->shape, fitter->model->n_vertices);
        wipe(fitter->fitted, fitter->model->n_vertices);
        free(fitter->modes);
        free(fitter->rows);
        free(fitter->face);
        free(fitter->shape);
        free(fitter->normal);
        free(fitter->fitted);
        free(fitter->residual_mm);
        free(fitter->meeting);
        free(fitter->gram);
        free(fitter->h);
        free(fitter);
    }
}

/* The head of the first n_modes coefficients; the rest count as 0. */
static void make_shape(struct iso_shape_fitter *f, const double *coefficient, int n_modes)
{
    _Alignas(ISO_GRAM_ALIGNMENT) float c[ISO_HEAD_IDENTITY_MAX + ISO_HEAD_EXPRESSION_MAX] = {0};
    for (int k = 0; k < n_modes; k++) {
        c[k] = (float)coefficient[k];
    }
    for (uint32_t i = 0; i < f->model->n_vertices; i++) {
        const float *x = modes_at(f, i), *y = x + f->mode_stride, *z = y + f->mode_stride;
        iso_lanes sum[3] = {{0}};
        for (int k = 0; k < f->mode_stride; k += ISO_GRAM_LANES) {
            iso_lanes some = iso_lanes_at(c + k);
            sum[0] += some * iso_lanes_at(x + k);
            sum[1] += some * iso_lanes_at(y + k);
            sum[2] += some * iso_lanes_at(z + k);
        }
        f->shape[i] = iso_add(
            f->model->mean_mm[i],
            iso_vec3(iso_lanes_sum(sum[0]), iso_lanes_sum(sum[1]), iso_lanes_sum(sum[2])));
    }
}

/* Row of the Jacobian, times a factor: turn and shift of the head, then its modes along the normal.
 */
static void jacobian(const struct iso_shape_fitter *f, const struct iso_rigid *pose,
                     uint32_t vertex, struct iso_vec3 normal, int n, double factor, float *row)
{
    struct iso_vec3 arm = iso_mat3_apply(&pose->rotation, f->shape[vertex]);
    struct iso_vec3 turn = iso_scale(factor, iso_cross(arm, normal));
    struct iso_vec3 shift = iso_scale(factor, normal);
    const double rigid[POSE] = {turn.x, turn.y, turn.z, shift.x, shift.y, shift.z};
    for (int k = 0; k < POSE; k++) {
        row[k] = (float)rigid[k];
    }
    struct iso_vec3 along = iso_scale(factor, f->normal[vertex]);
    float ax = (float)along.x, ay = (float)along.y, az = (float)along.z;
    const float *x = modes_at(f, vertex), *y = x + f->mode_stride, *z = y + f->mode_stride;
    for (int k = 0; k < n - POSE; k++) {
        row[POSE + k] = ax * x[k] + ay * y[k] + az * z[k];
    }
}

static void reshape(struct iso_shape_fitter *f, const struct state *state)
{
    make_shape(f, state->coefficient, f->n_modes);
    iso_head_normals(f->model, f->shape, f->normal);
}

/* Normal equations over n unknowns from the first n_vertices of the face, into f->h and g; returns
 * how many of them were measured. */
static int accumulate(struct iso_shape_fitter *f, const struct iso_frame *frame,
                      const struct iso_rigid *pose, const struct stride *stride,
                      double g[UNKNOWNS_MAX])
{
    int measured = 0, n_rows = 0, n = stride->n;
    int width = iso_gram_stride(n + 1);
    for (int i = 0; i < stride->n_vertices && i < f->n_face; i++) {
        uint32_t vertex = f->face[i];
        struct iso_vec3 normal = iso_mat3_apply(&pose->rotation, f->normal[vertex]);
        double r;
        if (iso_meet(frame, iso_rigid_apply(pose, f->shape[vertex]), normal, &r) !=
            ISO_MEETING_MEASURED) {
            continue;
        }
        measured++;
        double w = iso_tukey(r, stride->cutoff_mm);
        w *= f->model->region[vertex] & ISO_HEAD_RIGID ? 1.0 : f->options.soft_weight;
        if (w > 0.0) {
            float *row = &f->rows[(size_t)n_rows++ * (size_t)width];
            double factor = sqrt(w);
            jacobian(f, pose, vertex, normal, n, factor, row);
            row[n] = (float)(-factor * r);
            for (int k = n + 1; k < width; k++) {
                row[k] = 0.0f;
            }
        }
    }
    iso_gram(f->rows, n_rows, n + 1, f->gram);
    for (int a = 0; a < n; a++) {
        memcpy(&f->h[a * n], &f->gram[a * (n + 1)], (size_t)n * sizeof *f->h);
        g[a] = f->gram[n * (n + 1) + a];
    }
    return measured;
}

/* The modes' priors pull their coefficients to 0. */
static void add_priors(struct iso_shape_fitter *f, const double *coefficient, int n,
                       double g[UNKNOWNS_MAX])
{
    int identity = (int)f->model->n_identity;
    for (int k = 0; k < n - POSE; k++) {
        double stiffness = k < identity ? f->options.identity_stiffness_mm2
                                        : f->options.expression_stiffness_mm2;
        f->h[(k + POSE) * n + k + POSE] += stiffness;
        g[k + POSE] -= stiffness * coefficient[k];
    }
}

static int step(struct iso_shape_fitter *f, const struct iso_frame *frame,
                const struct stride *stride, struct state *state)
{
    double g[UNKNOWNS_MAX];
    int n = stride->n;
    if (accumulate(f, frame, &state->pose, stride, g) < MEASURED_MIN) {
        return -ENODATA;
    }
    add_priors(f, state->coefficient, n, g);
    if (iso_cholesky_factorise(f->h, n)) {
        return -ENODATA;
    }
    iso_cholesky_solve(f->h, n, g);
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(g[0], g[1], g[2]));
    state->pose.rotation = iso_mat3_mul(&turn, &state->pose.rotation);
    state->pose.translation_mm = iso_add(state->pose.translation_mm, iso_vec3(g[3], g[4], g[5]));
    for (int k = 0; k < n - POSE; k++) {
        state->coefficient[k] += g[k + POSE];
    }
    if (n > POSE) {
        reshape(f, state);
    }
    return 0;
}

/* Judges the fit vertex by vertex. */
static void measure(struct iso_shape_fitter *f, const struct iso_frame *frame,
                    const struct iso_rigid *pose, struct iso_pose_fit *out)
{
    struct iso_pose_tally tally = {0};
    memset(f->residual_mm, 0, f->model->n_vertices * sizeof *f->residual_mm);
    memset(f->meeting, ISO_MEETING_TURNED_AWAY, f->model->n_vertices * sizeof *f->meeting);
    for (int i = 0; i < f->n_face; i++) {
        uint32_t vertex = f->face[i];
        double r = 0.0;
        enum iso_meeting meeting = iso_meet(frame, iso_rigid_apply(pose, f->shape[vertex]),
                                            iso_mat3_apply(&pose->rotation, f->normal[vertex]), &r);
        f->meeting[vertex] = (uint8_t)meeting;
        f->residual_mm[vertex] = (float)r;
        iso_pose_tally_add(&tally, meeting, r);
    }
    out->camera_from_face = *pose;
    iso_pose_tally_finish(&tally, out);
}

/* Root mean square of coefficients, which are copied. */
static double copy_coefficients(const double *from, uint32_t n, float *to)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        to[k] = (float)from[k];
        sum += from[k] * from[k];
    }
    return n > 0 ? sqrt(sum / n) : 0.0;
}

/* Row of how one coordinate of a point of the head in the camera frame moves with the unknowns. */
static void point_jacobian(const struct iso_shape_fitter *f, const struct iso_rigid *pose,
                           struct iso_head_point point, int axis, int n, double j[UNKNOWNS_MAX])
{
    const uint32_t *corner = f->model->triangles[point.triangle];
    struct iso_vec3 along = {axis == 0, axis == 1, axis == 2};
    struct iso_vec3 arm = iso_mat3_apply(&pose->rotation,
                                         iso_head_point_on(f->model, f->fitted, point));
    struct iso_vec3 turn = iso_cross(arm, along);
    const double rigid[POSE] = {turn.x, turn.y, turn.z, along.x, along.y, along.z};
    memcpy(j, rigid, sizeof rigid);
    for (int k = POSE; k < n; k++) {
        const float *mode = mode_of(f->model, (uint32_t)(k - POSE));
        struct iso_vec3 moved = {0, 0, 0};
        for (int c = 0; c < 3; c++) {
            const float *m = &mode[3 * (size_t)corner[c]];
            double w = (double)point.weight[c];
            moved.x += w * (double)m[0];
            moved.y += w * (double)m[1];
            moved.z += w * (double)m[2];
        }
        j[k] = iso_dot(along, iso_mat3_apply(&pose->rotation, moved));
    }
}

/* Covariance of a point at the minimum: J H^-1 J' s^2, with H = L L' left by the last step, and s
 * the residual. (Gauss-Newton's; e.g. Triggs et al. 2000, sec. 9.) */
static double point_sigma_mm(const struct iso_shape_fitter *f, const struct iso_shape_fit *fit,
                             struct iso_head_point point, int n)
{
    double trace = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        double j[UNKNOWNS_MAX];
        point_jacobian(f, &fit->pose.camera_from_face, point, axis, n, j);
        for (int a = 0; a < n; a++) { /* L y = j; j' H^-1 j = y' y */
            double sum = j[a];
            for (int b = 0; b < a; b++) {
                sum -= f->h[a * n + b] * j[b];
            }
            j[a] = sum / f->h[a * n + a];
            trace += j[a] * j[a];
        }
    }
    return sqrt(trace * fit->pose.cost_mm2 * correlated_vertices);
}

static void report(struct iso_shape_fitter *f, const struct iso_frame *frame,
                   const struct state *state, struct iso_shape_fit *out)
{
    const struct iso_head_model *model = f->model;
    int n = POSE + f->n_modes;
    memset(out, 0, sizeof *out);
    measure(f, frame, &state->pose, &out->pose);
    out->identity_norm = copy_coefficients(state->coefficient, model->n_identity, out->identity);
    out->expression_norm = copy_coefficients(state->coefficient + model->n_identity,
                                             model->n_expression, out->expression);
    memcpy(f->fitted, f->shape, model->n_vertices * sizeof *f->fitted);
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        out->ibug_mm[i] = iso_head_point_on(model, f->fitted, model->landmarks[i]);
    }
    make_shape(f, state->coefficient, (int)model->n_identity);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_head_point point = model->landmarks[iso_landmark_ibug[l]];
        out->neutral_mm[l] = iso_head_point_on(model, f->shape, point);
        out->sigma_mm[l] = point_sigma_mm(f, out, point, n);
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
static int descend(struct iso_shape_fitter *f, const struct iso_frame *frame, int from, int to,
                   int n_vertices, struct state *state)
{
    int error = 0;
    for (int i = from; i < to && !error; i++) {
        struct stride stride = {n_vertices, POSE + f->n_modes,
                                cutoff_at(&f->options, i, f->options.iterations)};
        error = step(f, frame, &stride, state);
    }
    return error;
}

/* Begins the fit with the jaw open by `jaw` and says how well it goes. */
static int try_jaw(struct iso_shape_fitter *f, const struct iso_frame *frame,
                   const struct iso_rigid *pose, double jaw, struct state *state, double *cost_mm2)
{
    struct iso_pose_fit fit;
    memset(state, 0, sizeof *state);
    state->pose = *pose;
    state->coefficient[f->model->n_identity] = jaw * f->jaw_sign;
    reshape(f, state);
    int error = descend(f, frame, 0, trial_steps(&f->options), TRIAL_VERTICES, state);
    if (!error) {
        measure(f, frame, &state->pose, &fit);
        /* Where a closed mouth lies over an open one there are holes, which must count too. */
        *cost_mm2 = fit.coverage * fit.cost_mm2 + (1.0 - fit.coverage) * unmeasured_cost_mm2;
    }
    return error;
}

int iso_shape_fit(struct iso_shape_fitter *f, const struct iso_frame *frame,
                  const struct iso_rigid *start, struct iso_shape_fit *out)
{
    const struct iso_shape_fit_options *o = &f->options;
    struct state state = {.pose = *start};
    reshape(f, &state);
    int error = 0;
    const struct stride rigid = {TRIAL_VERTICES, POSE, o->cutoff_first_mm};
    for (int i = 0; i < o->rigid_iterations && !error; i++) {
        error = step(f, frame, &rigid, &state);
    }
    if (error) {
        return error;
    }
    struct iso_rigid pose = state.pose;
    double best_mm2 = INFINITY;
    for (int k = 0; k < o->jaws; k++) {
        struct state trial;
        double cost_mm2;
        if (!try_jaw(f, frame, &pose, jaw_starts[k], &trial, &cost_mm2) && cost_mm2 < best_mm2) {
            best_mm2 = cost_mm2;
            state = trial;
        }
    }
    if (!isfinite(best_mm2)) {
        return -ENODATA;
    }
    reshape(f, &state);
    error = descend(f, frame, trial_steps(o), o->iterations, f->n_face, &state);
    if (!error) {
        report(f, frame, &state, out);
    }
    return error;
}
