#include "core/landmark/pose_fit.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/base/solve.h"
#include "core/landmark/meet_many.h"
#include "core/landmark/pose_tally.h"

enum { DOF = 6, VERTICES_MIN = 30 };

enum { PAIRS = DOF / ISO_PAIR };

/* The normal equations of a step: h of the left side, of which only the lower triangle is set, and
 * g of the right side. */
struct equations {
    iso_pair h[DOF][PAIRS], g[PAIRS];
};

/* Adds the equation of a vertex: the row j of the Jacobian, the residual r, the weight w. The rows
 * are written out, because compilers do not unroll a loop over them. */
static void add_equation(struct equations *equations, const iso_pair j[PAIRS], double r, double w)
{
    const iso_pair a = w * j[0], b = w * j[1], c = w * j[2];
    iso_pair(*h)[PAIRS] = equations->h, *g = equations->g;
    h[0][0] += a[0] * j[0];
    h[1][0] += a[1] * j[0];
    h[2][0] += b[0] * j[0];
    h[2][1] += b[0] * j[1];
    h[3][0] += b[1] * j[0];
    h[3][1] += b[1] * j[1];
    h[4][0] += c[0] * j[0];
    h[4][1] += c[0] * j[1];
    h[4][2] += c[0] * j[2];
    h[5][0] += c[1] * j[0];
    h[5][1] += c[1] * j[1];
    h[5][2] += c[1] * j[2];
    g[0] -= a * r;
    g[1] -= b * r;
    g[2] -= c * r;
}

/* Compares the vertices from `first` on, at most ISO_MEET_MANY of n. Returns how many. */
static int meet(const struct iso_pose_vertices *vertices, int first, int n,
                const struct iso_frame *frame, const struct iso_rigid *pose, double cutoff_mm,
                struct iso_meetings *meetings)
{
    const int some = n - first < ISO_MEET_MANY ? n - first : ISO_MEET_MANY;
    iso_meet_many(frame, pose, &vertices->points[first / ISO_MEET_MANY], some, cutoff_mm, meetings);
    return some;
}

/* The normal equations of one Gauss-Newton step; returns how many vertices met a measurement. */
static int accumulate(const struct iso_pose_vertices *vertices, int n,
                      const struct iso_frame *frame, const struct iso_rigid *pose, double cutoff_mm,
                      struct equations *equations)
{
    struct iso_meetings m;
    int met = 0;
    for (int first = 0; first < n; first += ISO_MEET_MANY) {
        const int some = meet(vertices, first, n, frame, pose, cutoff_mm, &m);
        int counts[ISO_MEET_MANY] = {0}, n_counts = 0; /* the list is made without branches */
        for (int i = 0; i < some; i++) {
            met += m.meeting[i] == ISO_MEETING_MEASURED;
            counts[n_counts] = i;
            n_counts += m.weight[i] > 0.0;
        }
        for (int k = 0; k < n_counts; k++) {
            const int i = counts[k];
            const double w = vertices->weight[first + i] * m.weight[i];
            if (w > 0.0) {
                const iso_pair j[PAIRS] = {{m.turn_mm[0][i], m.turn_mm[1][i]},
                                           {m.turn_mm[2][i], m.normal[0][i]},
                                           {m.normal[1][i], m.normal[2][i]}};
                add_equation(equations, j, m.distance_mm[i], w);
            }
        }
    }
    return met;
}

/* Adds a weak prior that pulls the nose tip, the origin of the face frame, to where it was seen. */
static void add_prior(const struct iso_pose_options *options, const struct iso_rigid *pose,
                      double h[DOF * DOF], double g[DOF])
{
    /* The sum of squares has hundreds of vertices with residuals of about 2 mm. The prior counts as
     * much as ten of them. */
    const double w = 10.0 * 4.0 / (options->nose_sigma_mm * options->nose_sigma_mm);
    const struct iso_vec3 off = iso_sub(pose->translation_mm, options->nose_mm);
    const double r[3] = {off.x, off.y, off.z};
    for (int a = 0; a < 3; a++) {
        h[DOF * (a + 3) + a + 3] += w;
        g[a + 3] -= w * r[a];
    }
}

static void measure(const struct iso_pose_vertices *vertices, int n, const struct iso_frame *frame,
                    struct iso_pose_fit *fit)
{
    const double any_mm = 1.0; /* the weights are not used */
    struct iso_pose_tally tally = {0};
    struct iso_meetings m;
    for (int first = 0; first < n; first += ISO_MEET_MANY) {
        const int some = meet(vertices, first, n, frame, &fit->camera_from_face, any_mm, &m);
        for (int i = 0; i < some; i++) {
            iso_pose_tally_add(&tally, (enum iso_meeting)m.meeting[i], m.distance_mm[i]);
        }
    }
    iso_pose_tally_finish(&tally, fit);
}

int iso_pose_fit(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                 const struct iso_pose_options *options, const struct iso_rigid *start,
                 struct iso_pose_fit *out)
{
    struct iso_pose_fit fit = {.camera_from_face = *start};
    const int n = options->vertices > 0 && options->vertices < vertices->n ? options->vertices
                                                                           : vertices->n;
    const double fall = options->iterations > 1
                            ? pow(options->cutoff_last_mm / options->cutoff_first_mm,
                                  1.0 / (options->iterations - 1))
                            : 1.0;
    double cutoff = options->cutoff_first_mm;
    for (int step = 0; step < options->iterations; step++, cutoff *= fall) {
        struct equations equations;
        memset(&equations, 0, sizeof equations);
        struct iso_rigid *pose = &fit.camera_from_face;
        if (accumulate(vertices, n, frame, pose, cutoff, &equations) < VERTICES_MIN) {
            return -ENODATA;
        }
        double h[DOF * DOF], g[DOF];
        memcpy(h, equations.h, sizeof h);
        memcpy(g, equations.g, sizeof g);
        if (options->nose_sigma_mm > 0.0) {
            add_prior(options, pose, h, g);
        }
        if (iso_cholesky_factorise(h, DOF)) {
            return -ENODATA;
        }
        iso_cholesky_solve(h, DOF, g);
        struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(g[0], g[1], g[2]));
        pose->rotation = iso_mat3_mul(&turn, &pose->rotation);
        pose->translation_mm = iso_add(pose->translation_mm, iso_vec3(g[3], g[4], g[5]));
    }
    measure(vertices, n, frame, &fit);
    *out = fit;
    return 0;
}
