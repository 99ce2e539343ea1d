#include "core/landmark/pose_fit.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/base/solve.h"
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

/* The normal equations of one Gauss-Newton step; returns how many vertices met a measurement. */
static int accumulate(const struct iso_pose_vertices *vertices, int n,
                      const struct iso_frame *frame, const struct iso_rigid *pose, double cutoff_mm,
                      struct equations *equations)
{
    int met = 0;
    for (int i = 0; i < n; i++) {
        const struct iso_vec3 arm = iso_mat3_apply(&pose->rotation, vertices->point_mm[i]);
        const struct iso_vec3 normal = iso_mat3_apply(&pose->rotation, vertices->normal[i]);
        double r;
        if (iso_meet(frame, iso_add(arm, pose->translation_mm), normal, &r) !=
            ISO_MEETING_MEASURED) {
            continue;
        }
        met++;
        const double w = vertices->weight[i] * iso_tukey(r, cutoff_mm);
        if (w > 0.0) {
            const struct iso_vec3 turn = iso_cross(arm, normal);
            const iso_pair j[PAIRS] = {{turn.x, turn.y}, {turn.z, normal.x}, {normal.y, normal.z}};
            add_equation(equations, j, r, w);
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
    struct iso_pose_tally tally = {0};
    for (int i = 0; i < n; i++) {
        const struct iso_vec3 point = iso_rigid_apply(&fit->camera_from_face,
                                                      vertices->point_mm[i]);
        const struct iso_vec3 normal = iso_mat3_apply(&fit->camera_from_face.rotation,
                                                      vertices->normal[i]);
        double r = 0.0;
        const enum iso_meeting meeting = iso_meet(frame, point, normal, &r);
        iso_pose_tally_add(&tally, meeting, r);
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
