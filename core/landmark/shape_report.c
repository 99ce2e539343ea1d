/* What a fit of the head model reports: its residuals, its landmarks and their uncertainty. */
#include <math.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/landmark/pose_tally.h"
#include "core/landmark/shape_fitter.h"

/* Residuals of neighbouring vertices are alike, because the error of the model is smooth. There are
 * therefore fewer independent residuals than vertices, by this factor. It was chosen by
 * measurements so that sigma_mm is about the true error. */
static const double correlated_vertices = 12.0;

void iso__shape_measure(struct iso_shape_fitter *f, const struct iso_frame *frame,
                        const struct iso_rigid *pose, struct iso_pose_fit *out)
{
    struct iso_pose_tally tally = {0};
    memset(f->residual_mm, 0, f->model->n_vertices * sizeof *f->residual_mm);
    memset(f->meeting, ISO_MEETING_TURNED_AWAY, f->model->n_vertices * sizeof *f->meeting);
    struct iso_meetings m;
    for (int first = 0; first < f->n_face; first += ISO_MEET_MANY) {
        const double any_mm = 1.0; /* the weights are not used */
        const int n = iso__shape_meet(f, frame, pose, first, f->n_face, any_mm, &m);
        for (int i = 0; i < n; i++) {
            const uint32_t vertex = f->face[first + i];
            f->meeting[vertex] = (uint8_t)m.meeting[i];
            f->residual_mm[vertex] = (float)m.distance_mm[i];
            iso_pose_tally_add(&tally, (enum iso_meeting)m.meeting[i], m.distance_mm[i]);
        }
    }
    out->camera_from_face = *pose;
    iso_pose_tally_finish(&tally, out);
}

/* Copies coefficients. Returns their root mean square. */
static double copy_coefficients(const double *from, uint32_t n, float *to)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        to[k] = (float)from[k];
        sum += from[k] * from[k];
    }
    return n > 0 ? sqrt(sum / n) : 0.0;
}

/* Rows of the Jacobian, one for each axis of the camera frame: how a point of the head changes with
 * the unknowns. A lane is an axis; the last one is empty. */
static void point_jacobian(const struct iso_shape_fitter *f, const struct iso_rigid *pose,
                           struct iso_head_point point, int n,
                           iso_doubles j[ISO__SHAPE_UNKNOWNS_MAX])
{
    const uint32_t *corner = f->model->triangles[point.triangle];
    const struct iso_vec3 arm = iso_mat3_apply(&pose->rotation,
                                               iso_head_point_on(f->model, f->fitted, point));
    const iso_doubles rigid[ISO__SHAPE_POSE] = {
        {0.0, -arm.z, arm.y}, {arm.z, 0.0, -arm.x}, {-arm.y, arm.x, 0.0}, /* the turn */
        {1.0, 0.0, 0.0},      {0.0, 1.0, 0.0},      {0.0, 0.0, 1.0},      /* the shift */
    };
    memcpy(j, rigid, sizeof rigid);
    for (int k = ISO__SHAPE_POSE; k < n; k++) {
        const float *mode = iso__shape_mode(f->model, (uint32_t)(k - ISO__SHAPE_POSE));
        struct iso_vec3 moved = {0, 0, 0};
        for (int c = 0; c < 3; c++) {
            const float *m = &mode[3 * (size_t)corner[c]];
            const double w = (double)point.weight[c];
            moved.x += w * (double)m[0];
            moved.y += w * (double)m[1];
            moved.z += w * (double)m[2];
        }
        moved = iso_mat3_apply(&pose->rotation, moved);
        j[k] = (iso_doubles){moved.x, moved.y, moved.z};
    }
}

/* Covariance of a point at the minimum: J H^-1 J' s^2, with H = L L' left by the last step, and s
 * the residual. (Gauss-Newton's; e.g. Triggs et al. 2000, sec. 9.) */
static double point_sigma_mm(const struct iso_shape_fitter *f, const struct iso_shape_fit *fit,
                             struct iso_head_point point, int n)
{
    iso_doubles trace = {0}, j[ISO__SHAPE_UNKNOWNS_MAX];
    point_jacobian(f, &fit->pose.camera_from_face, point, n, j);
    for (int a = 0; a < n; a++) { /* L y = j; j' H^-1 j = y' y */
        iso_doubles sum = j[a];
        for (int b = 0; b < a; b++) {
            sum -= f->h[a * n + b] * j[b];
        }
        j[a] = sum / f->h[a * n + a];
        trace += j[a] * j[a];
    }
    return sqrt((trace[0] + trace[1] + trace[2]) * fit->pose.cost_mm2 * correlated_vertices);
}

void iso__shape_report(struct iso_shape_fitter *f, const struct iso_frame *frame,
                       const struct iso__shape_state *state, struct iso_shape_fit *out)
{
    const struct iso_head_model *model = f->model;
    const int n = ISO__SHAPE_POSE + f->n_modes;
    memset(out, 0, sizeof *out);
    iso__shape_measure(f, frame, &state->pose, &out->pose);
    out->identity_norm = copy_coefficients(state->coefficient, model->n_identity, out->identity);
    out->expression_norm = copy_coefficients(state->coefficient + model->n_identity,
                                             model->n_expression, out->expression);
    iso__shape_make(f, state->coefficient, f->n_modes, f->vertex + f->n_near,
                    (int)model->n_vertices - f->n_near);
    memcpy(f->fitted, f->shape, model->n_vertices * sizeof *f->fitted);
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        out->ibug_mm[i] = iso_head_point_on(model, f->fitted, model->landmarks[i]);
    }
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        const struct iso_head_point point = model->landmarks[iso_landmark_ibug[l]];
        iso__shape_make(f, state->coefficient, (int)model->n_identity,
                        model->triangles[point.triangle], 3);
        out->neutral_mm[l] = iso_head_point_on(model, f->shape, point);
        out->sigma_mm[l] = point_sigma_mm(f, out, point, n);
    }
}
