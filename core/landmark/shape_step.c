/* The steps of the head model's fit: the head of a state, and Gauss-Newton from one state to the
 * next. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/base/gram.h"
#include "core/base/solve.h"
#include "core/landmark/normals.h"
#include "core/landmark/shape_fitter.h"

/* Vertices that are made at once: whole groups. */
enum { SOME_VERTICES = 32 };

const float *iso__shape_mode(const struct iso_head_model *model, uint32_t k)
{
    const size_t stride = 3 * (size_t)model->n_vertices;
    return k < model->n_identity ? &model->identity_mm[k * stride]
                                 : &model->expression_mm[(k - model->n_identity) * stride];
}

void iso__shape_make(struct iso_shape_fitter *f, const double *coefficient, int n_modes, int first,
                     int end)
{
    _Alignas(ISO_GRAM_LINE) float c[ISO_HEAD_IDENTITY_MAX + ISO_HEAD_EXPRESSION_MAX] = {0};
    float moved_mm[SOME_VERTICES][ISO_SHAPE_AXES];
    for (int k = 0; k < n_modes; k++) {
        c[k] = (float)coefficient[k];
    }
    for (int place = first - first % ISO_SHAPE_GROUP; place < end; place += SOME_VERTICES) {
        const int n = end - place < SOME_VERTICES ? end - place : SOME_VERTICES;
        iso_shape_vertices(&f->modes[iso_shape_modes_of((size_t)place, f->mode_stride)],
                           f->mode_stride, c, n, moved_mm);
        for (int i = 0; i < n; i++) {
            const uint32_t vertex = f->vertex[place + i];
            f->shape[vertex] = iso_add(
                f->model->mean_mm[vertex],
                iso_vec3((double)moved_mm[i][0], (double)moved_mm[i][1], (double)moved_mm[i][2]));
        }
    }
}

void iso__shape_set(struct iso_shape_fitter *f, const struct iso__shape_state *state)
{
    iso__shape_make(f, state->coefficient, f->n_modes, 0, f->n_near);
    for (int i = 0; i < f->n_near; i++) {
        f->normal[f->vertex[i]] = iso_vec3(0, 0, 0);
    }
    iso_triangle_normals((const uint32_t(*)[3])f->triangle, (uint32_t)f->n_triangles, f->shape,
                         f->normal);
    for (int i = 0; i < f->n_face; i++) {
        f->normal[f->vertex[i]] = iso_unit(f->normal[f->vertex[i]]);
    }
}

/* A row of the Jacobian, times a factor, for point i of some that were compared: the turn and the
 * shift of the head, then its modes along the normal. */
static void fill_row(const struct iso_shape_fitter *f, const struct iso_meetings *meetings, int i,
                     uint32_t vertex, int n, double factor, float *row)
{
    for (int axis = 0; axis < 3; axis++) {
        row[axis] = (float)(factor * meetings->turn_mm[axis][i]);
        row[axis + 3] = (float)(factor * meetings->normal[axis][i]);
    }
    const struct iso_vec3 along = iso_scale(factor, f->normal[vertex]);
    float ax = (float)along.x, ay = (float)along.y, az = (float)along.z;
    const float *x = iso__shape_modes_at(f, vertex);
    float *moved = row + ISO__SHAPE_POSE;
    const int n_modes = n - ISO__SHAPE_POSE, n_lanes = n_modes - n_modes % ISO_GRAM_LANES;
    for (int k = 0; k < n_lanes; k += ISO_GRAM_LANES, x += ISO_SHAPE_GROUP_CHUNK) {
        ISO_GRAM_LANES_STORE(moved + k, ax * iso_gram_lanes_at(x) +
                                            ay * iso_gram_lanes_at(x + ISO_GRAM_LANES) +
                                            az * iso_gram_lanes_at(x + 2 * ISO_GRAM_LANES));
    }
    for (int k = 0; k < n_modes - n_lanes; k++) {
        moved[n_lanes + k] = ax * x[k] + ay * x[k + ISO_GRAM_LANES] +
                             az * x[k + 2 * ISO_GRAM_LANES];
    }
}

int iso__shape_meet(const struct iso_shape_fitter *f, const struct iso_frame *frame,
                    const struct iso_rigid *pose, int first, int end, double cutoff_mm,
                    struct iso_meetings *out)
{
    const int n = end - first < ISO_MEET_MANY ? end - first : ISO_MEET_MANY;
    struct iso_meet_points points;
    for (int i = 0; i < n; i++) {
        const uint32_t vertex = f->vertex[first + i];
        iso_meet_points_set(&points, i, f->shape[vertex], f->normal[vertex]);
    }
    iso_meet_points_fill(&points, n);
    iso_meet_many(frame, pose, &points, n, cutoff_mm, out);
    return n;
}

/* Appends the rows of the vertices from `first` on, at most ISO_MEET_MANY of end - first, to the
 * n_rows rows so far. Adds to *measured how many of them were measured. Returns the number of rows
 * then. */
static int add_rows(struct iso_shape_fitter *f, const struct iso_frame *frame,
                    const struct iso_rigid *pose, const struct iso__shape_unknowns *unknowns,
                    int first, int end, int n_rows, int *measured)
{
    const int n = unknowns->n, width = iso_gram_stride(n + 1);
    struct iso_meetings m;
    const int some = iso__shape_meet(f, frame, pose, first, end, unknowns->cutoff_mm, &m);
    for (int i = 0; i < some; i++) {
        const uint32_t vertex = f->vertex[first + i];
        const double soft = f->model->region[vertex] & ISO_HEAD_RIGID ? 1.0
                                                                      : f->options.soft_weight;
        const double w = m.weight[i] * soft;
        *measured += m.meeting[i] == ISO_MEETING_MEASURED;
        if (w > 0.0) {
            float *row = &f->rows[(size_t)n_rows++ * (size_t)width];
            const double factor = sqrt(w);
            fill_row(f, &m, i, vertex, n, factor, row);
            row[n] = (float)(-factor * m.distance_mm[i]);
            for (int k = n + 1; k < width; k++) {
                row[k] = 0.0f;
            }
        }
    }
    return n_rows;
}

/* Normal equations over n unknowns from the first n_vertices of the face, into f->h and g; returns
 * how many of them were measured. */
static int build_equations(struct iso_shape_fitter *f, const struct iso_frame *frame,
                           const struct iso_rigid *pose, const struct iso__shape_unknowns *unknowns,
                           double g[ISO__SHAPE_UNKNOWNS_MAX])
{
    const int n = unknowns->n;
    const int end = unknowns->n_vertices < f->n_face ? unknowns->n_vertices : f->n_face;
    int measured = 0, n_rows = 0;
    for (int first = 0; first < end; first += ISO_MEET_MANY) {
        n_rows = add_rows(f, frame, pose, unknowns, first, end, n_rows, &measured);
    }
    iso_gram(f->rows, n_rows, n + 1, f->gram);
    for (int a = 0; a < n; a++) { /* the lower triangle */
        memcpy(&f->h[a * n], &f->gram[a * (n + 1)], (size_t)(a + 1) * sizeof *f->h);
        g[a] = f->gram[n * (n + 1) + a];
    }
    return measured;
}

/* The modes' priors pull their coefficients to 0. */
static void add_priors(struct iso_shape_fitter *f, const double *coefficient, int n,
                       double g[ISO__SHAPE_UNKNOWNS_MAX])
{
    const int identity = (int)f->model->n_identity;
    for (int k = 0; k < n - ISO__SHAPE_POSE; k++) {
        const double stiffness = k < identity ? f->options.identity_stiffness_mm2
                                              : f->options.expression_stiffness_mm2;
        f->h[(k + ISO__SHAPE_POSE) * n + k + ISO__SHAPE_POSE] += stiffness;
        g[k + ISO__SHAPE_POSE] -= stiffness * coefficient[k];
    }
}

int iso__shape_step(struct iso_shape_fitter *f, const struct iso_frame *frame,
                    const struct iso__shape_unknowns *unknowns, struct iso__shape_state *state)
{
    double g[ISO__SHAPE_UNKNOWNS_MAX];
    const int n = unknowns->n;
    if (build_equations(f, frame, &state->pose, unknowns, g) < ISO__SHAPE_MEASURED_MIN) {
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
    for (int k = 0; k < n - ISO__SHAPE_POSE; k++) {
        state->coefficient[k] += g[k + ISO__SHAPE_POSE];
    }
    if (n > ISO__SHAPE_POSE) {
        iso__shape_set(f, state);
    }
    return 0;
}
