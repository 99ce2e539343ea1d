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

struct iso_shape_fitter {
    const struct iso_head_model *model;
    struct iso_shape_fit_options options;
    int n_face;
    uint32_t *face;         /* [n_face] vertices that are compared */
    struct iso_vec3 *shape; /* [n_vertices] the head as fitted so far, face frame */
    struct iso_vec3 *normal;
    double *h; /* [UNKNOWNS_MAX][UNKNOWNS_MAX] normal equations, lower triangle */
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
    f->h = calloc((size_t)UNKNOWNS_MAX * UNKNOWNS_MAX, sizeof *f->h);
    if (!f->face || !f->shape || !f->normal || !f->h) {
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
        if (fitter->shape) { /* biometric data */
            explicit_bzero(fitter->shape, fitter->model->n_vertices * sizeof *fitter->shape);
        }
        free(fitter->face);
        free(fitter->shape);
        free(fitter->normal);
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

/* Judges the fit, then takes the expression off: landmarks that stay where they are on the skull
 * whatever the mouth does are what two visits have in common. */
static void report(struct iso_shape_fitter *f, const struct iso_frame *frame,
                   const struct state *state, struct iso_shape_fit *out)
{
    struct iso_pose_tally tally = {0};
    for (int i = 0; i < f->n_face; i++) {
        uint32_t vertex = f->face[i];
        double r = 0.0;
        enum iso_meeting meeting = iso_meet(
            frame, iso_rigid_apply(&state->pose, f->shape[vertex]),
            iso_mat3_apply(&state->pose.rotation, f->normal[vertex]), &r);
        iso_pose_tally_add(&tally, meeting, r);
    }
    memset(out, 0, sizeof *out);
    out->pose.camera_from_face = state->pose;
    iso_pose_tally_finish(&tally, &out->pose);
    for (uint32_t k = 0; k < f->model->n_identity; k++) {
        out->identity[k] = (float)state->coefficient[k];
    }
    for (uint32_t k = 0; k < f->model->n_expression; k++) {
        out->expression[k] = (float)state->coefficient[f->model->n_identity + k];
    }
    make_shape(f, state->coefficient, f->model->n_identity);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        out->landmark_mm[l] = iso_head_point_on(f->model, f->shape,
                                                f->model->landmarks[iso_landmark_ibug[l]]);
    }
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
