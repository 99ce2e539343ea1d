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
            const uint32_t vertex = f->vertex[first + i];
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

/* Landmarks whose uncertainty is computed side by side, because a single substitution waits for
 * each of its sums; and the numbers of a row: x, y and z of each. */
enum { SIDE_BY_SIDE = 4, ROW = 3 * SIDE_BY_SIDE };

/* How a point of the head changes with mode k. */
static struct iso_vec3 moved_by(const struct iso_shape_fitter *f, struct iso_head_point point,
                                int k)
{
    struct iso_vec3 moved = {0, 0, 0};
    for (int c = 0; c < 3; c++) {
        const uint32_t vertex = f->model->triangles[point.triangle][c];
        const float *m = iso__shape_modes_at(f, vertex) + iso_shape_mode_at(k);
        const double w = (double)point.weight[c];
        moved.x += w * (double)m[0];
        moved.y += w * (double)m[ISO_GRAM_LANES];
        moved.z += w * (double)m[2 * ISO_GRAM_LANES];
    }
    return moved;
}

/* Columns `at` to `at` + 2 of the rows become the Jacobian of a point: how its three coordinates in
 * the camera frame change with the unknowns. */
static void point_jacobian(const struct iso_shape_fitter *f, const struct iso_rigid *pose,
                           struct iso_head_point point, int n, int at,
                           double j[ISO__SHAPE_UNKNOWNS_MAX][ROW])
{
    const struct iso_vec3 arm = iso_mat3_apply(&pose->rotation,
                                               iso_head_point_on(f->model, f->fitted, point));
    const double rigid[ISO__SHAPE_POSE][3] = {
        {0.0, -arm.z, arm.y}, {arm.z, 0.0, -arm.x}, {-arm.y, arm.x, 0.0}, /* the turn */
        {1.0, 0.0, 0.0},      {0.0, 1.0, 0.0},      {0.0, 0.0, 1.0},      /* the shift */
    };
    for (int k = 0; k < ISO__SHAPE_POSE; k++) {
        memcpy(&j[k][at], rigid[k], sizeof rigid[k]);
    }
    for (int k = ISO__SHAPE_POSE; k < n; k++) {
        const struct iso_vec3 moved = iso_mat3_apply(&pose->rotation,
                                                     moved_by(f, point, k - ISO__SHAPE_POSE));
        j[k][at] = moved.x;
        j[k][at + 1] = moved.y;
        j[k][at + 2] = moved.z;
    }
}

/* Solves L y = j for each column, in place. */
static void substitute(const double *l, int n, double j[ISO__SHAPE_UNKNOWNS_MAX][ROW])
{
    for (int a = 0; a < n; a++) {
        /* They have names, because compilers keep an array of them in memory. */
        iso_pair p = ISO_PAIR_LOAD(&j[a][0]), q = ISO_PAIR_LOAD(&j[a][2]),
                 r = ISO_PAIR_LOAD(&j[a][4]), s = ISO_PAIR_LOAD(&j[a][6]),
                 t = ISO_PAIR_LOAD(&j[a][8]), u = ISO_PAIR_LOAD(&j[a][10]);
        for (int b = 0; b < a; b++) {
            const double factor = l[a * n + b];
            p -= factor * ISO_PAIR_LOAD(&j[b][0]);
            q -= factor * ISO_PAIR_LOAD(&j[b][2]);
            r -= factor * ISO_PAIR_LOAD(&j[b][4]);
            s -= factor * ISO_PAIR_LOAD(&j[b][6]);
            t -= factor * ISO_PAIR_LOAD(&j[b][8]);
            u -= factor * ISO_PAIR_LOAD(&j[b][10]);
        }
        const double pivot = l[a * n + a];
        ISO_PAIR_STORE(&j[a][0], p / pivot);
        ISO_PAIR_STORE(&j[a][2], q / pivot);
        ISO_PAIR_STORE(&j[a][4], r / pivot);
        ISO_PAIR_STORE(&j[a][6], s / pivot);
        ISO_PAIR_STORE(&j[a][8], t / pivot);
        ISO_PAIR_STORE(&j[a][10], u / pivot);
    }
}

/* Uncertainty of the landmarks from `first` on: the covariance of a point at the minimum is
 * J H^-1 J' s^2, with H = L L' left by the last step, and s the residual. (Gauss-Newton's; e.g.
 * Triggs et al. 2000, sec. 9.) With L y = J', J H^-1 J' = y' y. */
static void find_sigmas(const struct iso_shape_fitter *f, int first, int n,
                        struct iso_shape_fit *fit)
{
    double j[ISO__SHAPE_UNKNOWNS_MAX][ROW], trace[ROW] = {0};
    for (int k = 0; k < SIDE_BY_SIDE; k++) {
        point_jacobian(f, &fit->pose.camera_from_face,
                       f->model->landmarks[iso_landmark_ibug[first + k]], n, 3 * k, j);
    }
    substitute(f->h, n, j);
    for (int a = 0; a < n; a++) {
        for (int i = 0; i < ROW; i++) {
            trace[i] += j[a][i] * j[a][i];
        }
    }
    for (int k = 0; k < SIDE_BY_SIDE; k++) {
        const double *t = &trace[3 * k];
        fit->sigma_mm[first + k] = sqrt((t[0] + t[1] + t[2]) * fit->pose.cost_mm2 *
                                        correlated_vertices);
    }
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
    iso__shape_make(f, state->coefficient, f->n_modes, f->n_near, (int)model->n_vertices);
    memcpy(f->fitted, f->shape, model->n_vertices * sizeof *f->fitted);
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        out->ibug_mm[i] = iso_head_point_on(model, f->fitted, model->landmarks[i]);
    }
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        const struct iso_head_point point = model->landmarks[iso_landmark_ibug[l]];
        for (int c = 0; c < 3; c++) {
            const int place = (int)f->place[model->triangles[point.triangle][c]];
            iso__shape_make(f, state->coefficient, (int)model->n_identity, place, place + 1);
        }
        out->neutral_mm[l] = iso_head_point_on(model, f->shape, point);
    }
    _Static_assert(ISO_LANDMARKS % SIDE_BY_SIDE == 0, "the landmarks are whole groups");
    for (int l = 0; l < ISO_LANDMARKS; l += SIDE_BY_SIDE) {
        find_sigmas(f, l, n, out);
    }
}
