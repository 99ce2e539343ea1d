#include "core/landmark/shape_fit.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/landmark/normals.h"
#include "core/landmark/pose_tally.h"
#include "core/math/solve.h"

enum {
    POSE = 6,
    UNKNOWNS_MAX = POSE + ISO_HEAD_IDENTITY_MAX + ISO_HEAD_EXPRESSION_MAX,
    MEASURED_MIN = 100,
};

/* Residuals of neighbouring vertices are alike (the model's own error is smooth), so that there are
 * fewer independent ones than vertices: measured, so that sigma_mm is about the true error. */
static const double correlated_vertices = 12.0;

struct iso_shape_fitter {
    const struct iso_head_model *model;
    struct iso_shape_fit_options options;
    int n_face;
    uint32_t *face;         /* [n_face] vertices that are compared */
    struct iso_vec3 *shape; /* [n_vertices] the head as fitted so far, face frame */
    struct iso_vec3 *normal;
    struct iso_vec3 *fitted; /* [n_vertices] the last fit, its expression on */
    float *residual_mm;      /* [n_vertices] of the last fit */
    uint8_t *meeting;        /* [n_vertices] */
    double
        *h; /* [UNKNOWNS_MAX][UNKNOWNS_MAX] normal equations, lower triangle; then their factor */
};

/* The state of a fit. */
struct state {
    struct iso_rigid pose;
    double coefficient[ISO_HEAD_IDENTITY_MAX + ISO_HEAD_EXPRESSION_MAX]; /* identity first */
};

static bool options_sane(const struct iso_shape_fit_options *o)
{
    return o->rigid_iterations >= 1 && o->rigid_iterations <= 64 && o->iterations >= 1 &&
           o->iterations <= 64 && o->cutoff_last_mm > 0.0 &&
           o->cutoff_first_mm >= o->cutoff_last_mm && isfinite(o->cutoff_first_mm) &&
           o->soft_weight >= 0.0 && o->soft_weight <= 1.0 && o->identity_stiffness_mm2 > 0.0 &&
           o->expression_stiffness_mm2 > 0.0;
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
    f->face = calloc(model->n_vertices, sizeof *f->face);
    f->shape = calloc(model->n_vertices, sizeof *f->shape);
    f->normal = calloc(model->n_vertices, sizeof *f->normal);
    f->fitted = calloc(model->n_vertices, sizeof *f->fitted);
    f->residual_mm = calloc(model->n_vertices, sizeof *f->residual_mm);
    f->meeting = calloc(model->n_vertices, sizeof *f->meeting);
    f->h = calloc((size_t)UNKNOWNS_MAX * UNKNOWNS_MAX, sizeof *f->h);
    if (!f->face || !f->shape || !f->normal || !f->fitted || !f->residual_mm || !f->meeting ||
        !f->h) {
        iso_shape_fitter_free(f);
        return -ENOMEM;
    }
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        if (model->region[i] & ISO_HEAD_FACE) {
            f->face[f->n_face++] = i;
        }
    }
    if (f->n_face < MEASURED_MIN) {
        iso_shape_fitter_free(f);
        return -EINVAL;
    }
    *out = f;
    return 0;
}

void iso_shape_fitter_free(struct iso_shape_fitter *fitter)
{
    if (fitter) {
        size_t n = fitter->model->n_vertices;
        if (fitter->shape) { /* biometric data */
            explicit_bzero(fitter->shape, n * sizeof *fitter->shape);
        }
        if (fitter->fitted) {
            explicit_bzero(fitter->fitted, n * sizeof *fitter->fitted);
        }
        free(fitter->face);
        free(fitter->shape);
        free(fitter->normal);
        free(fitter->fitted);
        free(fitter->residual_mm);
        free(fitter->meeting);
        free(fitter->h);
        free(fitter);
    }
}

/* Mode k, identity first, as [n_vertices][3]. */
static const float *mode_of(const struct iso_head_model *model, uint32_t k)
{
    size_t stride = 3 * (size_t)model->n_vertices;
    return k < model->n_identity ? &model->identity_mm[k * stride]
                                 : &model->expression_mm[(k - model->n_identity) * stride];
}

/* The head of the first n_modes coefficients; the rest count as 0. */
static void make_shape(struct iso_shape_fitter *f, const double *coefficient, uint32_t n_modes)
{
    const struct iso_head_model *model = f->model;
    memcpy(f->shape, model->mean_mm, model->n_vertices * sizeof *f->shape);
    for (uint32_t k = 0; k < n_modes; k++) {
        const float *mode = mode_of(model, k);
        double c = coefficient[k];
        for (uint32_t i = 0; c != 0.0 && i < model->n_vertices; i++, mode += 3) {
            f->shape[i].x += c * (double)mode[0];
            f->shape[i].y += c * (double)mode[1];
            f->shape[i].z += c * (double)mode[2];
        }
    }
}

/* Row of the Jacobian: turn and shift of the head, then its modes along the normal. */
static void jacobian(const struct iso_shape_fitter *f, const struct iso_rigid *pose,
                     uint32_t vertex, struct iso_vec3 normal, int n, double j[UNKNOWNS_MAX])
{
    struct iso_vec3 arm = iso_mat3_apply(&pose->rotation, f->shape[vertex]);
    struct iso_vec3 turn = iso_cross(arm, normal);
    const double rigid[POSE] = {turn.x, turn.y, turn.z, normal.x, normal.y, normal.z};
    memcpy(j, rigid, sizeof rigid);
    struct iso_vec3 along = f->normal[vertex];
    for (int k = POSE; k < n; k++) {
        const float *m = &mode_of(f->model, (uint32_t)(k - POSE))[3 * (size_t)vertex];
        j[k] = along.x * (double)m[0] + along.y * (double)m[1] + along.z * (double)m[2];
    }
}

/* Normal equations over n unknowns; returns how many vertices were measured. */
static int accumulate(struct iso_shape_fitter *f, const struct iso_frame *frame,
                      const struct iso_rigid *pose, double cutoff_mm, int n, double g[UNKNOWNS_MAX])
{
    int measured = 0;
    memset(f->h, 0, (size_t)n * (size_t)n * sizeof *f->h);
    memset(g, 0, (size_t)n * sizeof *g);
    for (int i = 0; i < f->n_face; i++) {
        uint32_t vertex = f->face[i];
        struct iso_vec3 normal = iso_mat3_apply(&pose->rotation, f->normal[vertex]);
        double r;
        if (iso_meet(frame, iso_rigid_apply(pose, f->shape[vertex]), normal, &r) !=
            ISO_MEETING_MEASURED) {
            continue;
        }
        measured++;
        double w = iso_tukey(r, cutoff_mm);
        w *= f->model->region[vertex] & ISO_HEAD_RIGID ? 1.0 : f->options.soft_weight;
        if (!(w > 0.0)) {
            continue;
        }
        double j[UNKNOWNS_MAX];
        jacobian(f, pose, vertex, normal, n, j);
        for (int a = 0; a < n; a++) {
            double wj = w * j[a];
            for (int b = 0; b <= a; b++) {
                f->h[a * n + b] += wj * j[b];
            }
            g[a] -= wj * r;
        }
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

static int step(struct iso_shape_fitter *f, const struct iso_frame *frame, double cutoff_mm, int n,
                struct state *state)
{
    double g[UNKNOWNS_MAX];
    if (accumulate(f, frame, &state->pose, cutoff_mm, n, g) < MEASURED_MIN) {
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
        make_shape(f, state->coefficient, (uint32_t)(n - POSE));
        iso_head_normals(f->model, f->shape, f->normal);
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
    int n = POSE + (int)(model->n_identity + model->n_expression);
    memset(out, 0, sizeof *out);
    measure(f, frame, &state->pose, &out->pose);
    out->identity_norm = copy_coefficients(state->coefficient, model->n_identity, out->identity);
    out->expression_norm = copy_coefficients(state->coefficient + model->n_identity,
                                             model->n_expression, out->expression);
    memcpy(f->fitted, f->shape, model->n_vertices * sizeof *f->fitted);
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        out->ibug_mm[i] = iso_head_point_on(model, f->fitted, model->landmarks[i]);
    }
    make_shape(f, state->coefficient, model->n_identity);
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

int iso_shape_fit(struct iso_shape_fitter *f, const struct iso_frame *frame,
                  const struct iso_rigid *start, struct iso_shape_fit *out)
{
    const struct iso_shape_fit_options *o = &f->options;
    struct state state = {.pose = *start};
    make_shape(f, state.coefficient, 0);
    iso_head_normals(f->model, f->shape, f->normal);
    int error = 0;
    for (int i = 0; i < o->rigid_iterations && !error; i++) {
        error = step(f, frame, o->cutoff_first_mm, POSE, &state);
    }
    double fall = pow(o->cutoff_last_mm / o->cutoff_first_mm, 1.0 / fmax(o->iterations - 1, 1));
    double cutoff = o->cutoff_first_mm;
    int n = POSE + (int)(f->model->n_identity + f->model->n_expression);
    for (int i = 0; i < o->iterations && !error; i++, cutoff *= fall) {
        error = step(f, frame, cutoff, n, &state);
    }
    if (!error) {
        report(f, frame, &state, out);
    }
    return error;
}
