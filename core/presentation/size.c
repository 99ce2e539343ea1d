#include "core/presentation/size.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/base/solve.h"
#include "core/landmark/meet_many.h"
#include "core/landmark/normals.h"
#include "core/landmark/pose_tally.h"

enum {
    SIMILARITY = 7,
    MODES_MAX = 20,
    UNKNOWNS_MAX = SIMILARITY + MODES_MAX,
    VERTICES = 200,
    VERTICES_MIN = 60,
    MEASURED_MIN = 30,
    STEPS = 6,
    STEPS_SHAPED = 6,
};

static const double cutoff_first_mm = 14.0, cutoff_last_mm = 6.0;
/* Several starts, because the fit does not reach a surface of a very different size from that of
 * people. */
static const double starts[] = {1.0, 0.72, 1.35};
static const double scale_min = 0.3, scale_max = 2.2;
/* The weight of the modes' prior beside the squared residual of a vertex. */
static const double stiffness_mm2 = 4.0;

/* A surface at least this far in front of a vertex above the eyebrows is taken for hair. Bare
 * foreheads differ by less from the shaped mean face. The fringes of real people (Kinect v2) lie 4
 * to 10 mm in front of it. */
static const double hair_before_mm = 4.0;

enum { BROW_IBUG = 19 };

struct iso_sizer {
    int n, n_modes;
    double brow_mm;            /* height of the eyebrows, face frame */
    struct iso_vec3 *point_mm; /* [n], face frame */
    struct iso_vec3 *normal;   /* [n] */
    struct iso_vec3 *mode_mm;  /* [n][n_modes] */
    double *along_mm;          /* [n][n_modes] the modes along the normal */
};

struct state {
    struct iso_rigid pose;
    double scale, coefficient[MODES_MAX];
};

/* Chooses at most VERTICES of the rigid vertices, at even steps. Returns how many. */
static int choose_vertices(const struct iso_head_model *model, uint32_t vertex[VERTICES])
{
    int rigid = 0, n = 0, seen = 0;
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        rigid += (model->region[i] & ISO_HEAD_RIGID) != 0;
    }
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        if (model->region[i] & ISO_HEAD_RIGID) {
            /* Bresenham's way of even steps: at most VERTICES of them. */
            int before = seen * VERTICES / rigid, after = (seen + 1) * VERTICES / rigid;
            seen++;
            if (rigid <= VERTICES || after > before) {
                vertex[n++] = i;
            }
        }
    }
    return n;
}

static void fill_sizer(struct iso_sizer *s, const struct iso_head_model *model,
                       const uint32_t *vertex, const struct iso_vec3 *normals)
{
    s->brow_mm = iso_head_point_on(model, model->mean_mm, model->landmarks[BROW_IBUG]).y;
    for (int i = 0; i < s->n; i++) {
        s->point_mm[i] = model->mean_mm[vertex[i]];
        s->normal[i] = normals[vertex[i]];
        for (int k = 0; k < s->n_modes; k++) {
            const float *m = &model->identity_mm[3 * ((size_t)k * model->n_vertices + vertex[i])];
            const struct iso_vec3 mode = iso_vec3((double)m[0], (double)m[1], (double)m[2]);
            s->mode_mm[i * s->n_modes + k] = mode;
            s->along_mm[i * s->n_modes + k] = iso_dot(s->normal[i], mode);
        }
    }
}

int iso_sizer_new(const struct iso_head_model *model, struct iso_sizer **out)
{
    uint32_t vertex[VERTICES];
    const int n = choose_vertices(model, vertex);
    if (n < VERTICES_MIN) {
        return -EINVAL;
    }
    struct iso_vec3 *normals = calloc(model->n_vertices, sizeof *normals);
    struct iso_sizer *s = calloc(1, sizeof *s);
    if (s) {
        s->n = n;
        s->n_modes = model->n_identity < MODES_MAX ? (int)model->n_identity : MODES_MAX;
        s->point_mm = calloc((size_t)n, sizeof *s->point_mm);
        s->normal = calloc((size_t)n, sizeof *s->normal);
        s->mode_mm = calloc((size_t)n * MODES_MAX, sizeof *s->mode_mm);
        s->along_mm = calloc((size_t)n * MODES_MAX, sizeof *s->along_mm);
    }
    if (!normals || !s || !s->point_mm || !s->normal || !s->mode_mm || !s->along_mm) {
        free(normals);
        iso_sizer_free(s);
        return -ENOMEM;
    }
    iso_head_normals(model, model->mean_mm, normals);
    fill_sizer(s, model, vertex, normals);
    free(normals);
    *out = s;
    return 0;
}

void iso_sizer_free(struct iso_sizer *sizer)
{
    if (sizer) {
        free(sizer->point_mm);
        free(sizer->normal);
        free(sizer->mode_mm);
        free(sizer->along_mm);
        free(sizer);
    }
}

/* A vertex of the scaled, shaped mean face about its origin, face frame. */
static struct iso_vec3 vertex_of(const struct iso_sizer *s, const struct state *state, int i,
                                 int n_modes)
{
    struct iso_vec3 p = s->point_mm[i];
    for (int k = 0; k < n_modes; k++) {
        p = iso_madd(p, state->coefficient[k], s->mode_mm[i * s->n_modes + k]);
    }
    return iso_scale(state->scale, p);
}

/* Whether a measured surface at signed distance r of a vertex is hair before the forehead. */
static bool is_hair(const struct iso_sizer *s, int i, double r_mm)
{
    return r_mm < -hair_before_mm && s->point_mm[i].y > s->brow_mm;
}

static void apply_step(const double *g, int n_modes, struct state *state)
{
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(g[0], g[1], g[2]));
    state->pose.rotation = iso_mat3_mul(&turn, &state->pose.rotation);
    state->pose.translation_mm = iso_add(state->pose.translation_mm, iso_vec3(g[3], g[4], g[5]));
    state->scale *= exp(fmin(fmax(g[6], -0.2), 0.2));
    for (int k = 0; k < n_modes; k++) {
        state->coefficient[k] += g[SIMILARITY + k];
    }
}

/* The normal equations of a step. Rows are padded, so that they are summed ISO_PAIR entries at a
 * time; of h only the lower triangle means anything. */
enum { PADDED = (UNKNOWNS_MAX + 1) / ISO_PAIR * ISO_PAIR };

struct equations {
    double h[UNKNOWNS_MAX][PADDED], g[UNKNOWNS_MAX];
};

/* Adds the equation of a vertex: the row j of the Jacobian, the residual r, the weight w. */
static void add_equation(struct equations *equations, const double j[PADDED], int n, double r,
                         double w)
{
    for (int a = 0; a < n; a++) {
        const double wj = w * j[a];
        double *h = equations->h[a];
#pragma GCC unroll 2
        for (int b = 0; b <= a; b += ISO_PAIR) {
            ISO_PAIR_STORE(h + b, ISO_PAIR_LOAD(h + b) + wj * ISO_PAIR_LOAD(j + b));
        }
        equations->g[a] -= wj * r;
    }
}

/* Compares the vertices from `first` on, at most ISO_MEET_MANY, with the frame. Returns how many.
 */
static int meet(const struct iso_sizer *s, const struct iso_frame *frame, double cutoff_mm,
                int n_modes, const struct state *state, int first, struct iso_meet_points *points,
                struct iso_meetings *out)
{
    const int n = s->n - first < ISO_MEET_MANY ? s->n - first : ISO_MEET_MANY;
    for (int i = 0; i < n; i++) {
        iso_meet_points_set(points, i, vertex_of(s, state, first + i, n_modes),
                            s->normal[first + i]);
    }
    iso_meet_points_fill(points, n);
    iso_meet_many(frame, &state->pose, points, n, cutoff_mm, out);
    return n;
}

/* Adds the equations of the vertices from `first` on, at most ISO_MEET_MANY. Adds to *measured how
 * many of them were measured. */
static void add_equations(const struct iso_sizer *s, const struct iso_frame *frame,
                          double cutoff_mm, int n_modes, const struct state *state, int first,
                          struct equations *equations, int *measured)
{
    struct iso_meet_points points;
    struct iso_meetings m;
    const int n = meet(s, frame, cutoff_mm, n_modes, state, first, &points, &m);
    double j[PADDED] = {0};
    for (int k = 0; k < n; k++) {
        const int i = first + k;
        const double w = n_modes > 0 && is_hair(s, i, m.distance_mm[k]) ? 0.0 : m.weight[k];
        *measured += m.meeting[k] == ISO_MEETING_MEASURED;
        if (!(w > 0.0)) {
            continue;
        }
        const struct iso_vec3 normal = {m.normal[0][k], m.normal[1][k], m.normal[2][k]};
        const struct iso_vec3 arm = iso_mat3_apply(
            &state->pose.rotation,
            iso_vec3(points.point_mm[0][k], points.point_mm[1][k], points.point_mm[2][k]));
        /* The scale by its logarithm: d(s p) = s p d(ln s). */
        const double similarity[SIMILARITY] = {
            m.turn_mm[0][k], m.turn_mm[1][k], m.turn_mm[2][k],     normal.x,
            normal.y,        normal.z,        iso_dot(arm, normal)};
        memcpy(j, similarity, sizeof similarity);
        for (int mode = 0; mode < n_modes; mode++) {
            j[SIMILARITY + mode] = state->scale * s->along_mm[i * s->n_modes + mode];
        }
        add_equation(equations, j, SIMILARITY + n_modes, m.distance_mm[k], w);
    }
}

static int take_step(const struct iso_sizer *s, const struct iso_frame *frame, double cutoff_mm,
                     int n_modes, struct state *state)
{
    struct equations equations;
    double h[UNKNOWNS_MAX * UNKNOWNS_MAX], *g = equations.g;
    const int n = SIMILARITY + n_modes;
    memset(&equations, 0, sizeof equations);
    int measured = 0;
    for (int first = 0; first < s->n; first += ISO_MEET_MANY) {
        add_equations(s, frame, cutoff_mm, n_modes, state, first, &equations, &measured);
    }
    if (measured < MEASURED_MIN) {
        return -ENODATA;
    }
    for (int a = 0; a < n; a++) {
        memcpy(&h[a * n], equations.h[a], (size_t)n * sizeof *h);
    }
    for (int k = 0; k < n_modes; k++) {
        h[(SIMILARITY + k) * (n + 1)] += stiffness_mm2;
        g[SIMILARITY + k] -= stiffness_mm2 * state->coefficient[k];
    }
    if (iso_cholesky_factorise(h, n)) {
        return -ENODATA;
    }
    iso_cholesky_solve(h, n, g);
    apply_step(g, n_modes, state);
    return state->scale > scale_min && state->scale < scale_max ? 0 : -ENODATA;
}

/* The cost over all vertices, or over the bare ones alone (size.h). */
static double cost_of(const struct iso_sizer *s, const struct iso_frame *frame,
                      const struct state *state, int n_modes, bool bare_only)
{
    const double any_mm = 1.0; /* the weights are not used */
    struct iso_pose_tally tally = {0};
    struct iso_pose_fit fit;
    struct iso_meet_points points;
    struct iso_meetings m;
    for (int first = 0; first < s->n; first += ISO_MEET_MANY) {
        const int n = meet(s, frame, any_mm, n_modes, state, first, &points, &m);
        for (int k = 0; k < n; k++) {
            const enum iso_meeting meeting = (enum iso_meeting)m.meeting[k];
            if (!bare_only || meeting != ISO_MEETING_MEASURED ||
                !is_hair(s, first + k, m.distance_mm[k])) {
                iso_pose_tally_add(&tally, meeting, m.distance_mm[k]);
            }
        }
    }
    iso_pose_tally_finish(&tally, &fit);
    return fit.cost_mm2;
}

int iso_size_measure(const struct iso_sizer *sizer, const struct iso_frame *frame,
                     const struct iso_rigid *camera_from_face, struct iso_size *out)
{
    struct state best = {.scale = 0.0};
    double least = INFINITY, fall = pow(cutoff_last_mm / cutoff_first_mm, 1.0 / (STEPS - 1));
    int error = 0;
    for (size_t k = 0; k < sizeof starts / sizeof starts[0]; k++) {
        struct state state = {.pose = *camera_from_face, .scale = starts[k]};
        double cutoff = cutoff_first_mm;
        error = 0;
        for (int i = 0; i < STEPS && !error; i++, cutoff *= fall) {
            error = take_step(sizer, frame, cutoff, 0, &state);
        }
        const double cost = error ? INFINITY : cost_of(sizer, frame, &state, 0, false);
        if (cost < least) {
            best = state;
            least = cost;
        }
    }
    error = isfinite(least) ? 0 : -ENODATA;
    for (int i = 0; i < STEPS_SHAPED && !error; i++) {
        error = take_step(sizer, frame, cutoff_last_mm, sizer->n_modes, &best);
    }
    if (!error) {
        *out = (struct iso_size){best.scale, cost_of(sizer, frame, &best, sizer->n_modes, true)};
    }
    return error;
}

/* Sum of squared distances of the rigid vertices from their middle. */
static double spread_of(const struct iso_head_model *model, const struct iso_vec3 *vertex_mm)
{
    struct iso_vec3 sum = {0, 0, 0};
    double squares = 0.0;
    int n = 0;
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        if (model->region[i] & ISO_HEAD_RIGID) {
            sum = iso_add(sum, vertex_mm[i]);
            squares += iso_dot(vertex_mm[i], vertex_mm[i]);
            n++;
        }
    }
    return n > 0 ? squares - iso_dot(sum, sum) / n : 0.0;
}

double iso_size_of_fit(const struct iso_head_model *model, const struct iso_vec3 *vertex_mm)
{
    return sqrt(spread_of(model, vertex_mm) / spread_of(model, model->mean_mm));
}
