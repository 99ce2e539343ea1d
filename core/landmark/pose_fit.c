#include "core/landmark/pose_fit.h"

#include <errno.h>
#include <math.h>

#include "core/math/solve.h"

enum { DOF = 6, VERTICES_MIN = 30 };

static const double cost_limit_mm2 = 36.0;
/* A vertex counts as front-facing if its normal is within 75 degrees of the line of sight. */
static const double facing_cosine = 0.26;
/* Depths to either side of a pixel belong together if they differ by less. */
static const double together_mm = 10.0;

/* What one vertex meets in the frame. */
enum meeting { TURNED_AWAY, OUTSIDE, NOT_MEASURED, MEASURED };

/* Depth between pixels: bilinear where the four around belong together, else the nearest. */
static double depth_between(const struct iso_frame *frame, double column, double row)
{
    int u = (int)floor(column), v = (int)floor(row);
    if (u < frame->width_px - 1 && v < frame->height_px - 1) {
        double a = (double)iso_frame_depth_at(frame, u, v);
        double b = (double)iso_frame_depth_at(frame, u + 1, v);
        double c = (double)iso_frame_depth_at(frame, u, v + 1);
        double d = (double)iso_frame_depth_at(frame, u + 1, v + 1);
        double low = fmin(fmin(a, b), fmin(c, d)), high = fmax(fmax(a, b), fmax(c, d));
        if (low > 0.0 && high - low < together_mm) {
            double s = column - u, t = row - v;
            return (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * c + s * d);
        }
    }
    return (double)iso_frame_depth_at(frame, (int)(column + 0.5), (int)(row + 0.5));
}

/* Signed distance of a camera-frame vertex from the measured surface along its normal. */
static enum meeting meet(const struct iso_frame *frame, struct iso_vec3 point,
                         struct iso_vec3 normal, double *distance_mm)
{
    double toward = frame->camera.projection == ISO_PINHOLE
                        ? -iso_dot(normal, point) / iso_norm(point)
                        : -normal.z;
    if (toward < facing_cosine) {
        return TURNED_AWAY;
    }
    double u, v;
    if (!iso_camera_project(&frame->camera, point, &u, &v)) {
        return OUTSIDE;
    }
    double column = u - frame->crop_x_px, row = v - frame->crop_y_px;
    if (!(column >= 0.0 && row >= 0.0 && column < frame->width_px - 0.5 &&
          row < frame->height_px - 0.5)) {
        return OUTSIDE;
    }
    double z = depth_between(frame, column, row);
    if (!(z > 0.0)) {
        return NOT_MEASURED;
    }
    struct iso_vec3 measured = iso_camera_back_project(&frame->camera, u, v, z);
    *distance_mm = iso_dot(normal, iso_sub(point, measured));
    return MEASURED;
}

static double tukey(double r, double cutoff)
{
    double s = r / cutoff;
    return fabs(s) < 1.0 ? (1 - s * s) * (1 - s * s) : 0.0;
}

/* Normal equations of one Gauss-Newton step; returns how many vertices met a measurement. */
static int accumulate(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                      const struct iso_rigid *pose, double cutoff_mm, double h[DOF * DOF],
                      double g[DOF])
{
    int met = 0;
    for (int i = 0; i < vertices->n; i++) {
        struct iso_vec3 arm = iso_mat3_apply(&pose->rotation, vertices->point_mm[i]);
        struct iso_vec3 normal = iso_mat3_apply(&pose->rotation, vertices->normal[i]);
        double r;
        if (meet(frame, iso_add(arm, pose->translation_mm), normal, &r) != MEASURED) {
            continue;
        }
        met++;
        double w = vertices->weight[i] * tukey(r, cutoff_mm);
        struct iso_vec3 turn = iso_cross(arm, normal);
        const double j[DOF] = {turn.x, turn.y, turn.z, normal.x, normal.y, normal.z};
        for (int a = 0; a < DOF; a++) {
            for (int b = 0; b <= a; b++) {
                h[DOF * a + b] += w * j[a] * j[b];
            }
            g[a] -= w * j[a] * r;
        }
    }
    return met;
}

/* A weak pull of the nose tip, the face frame's origin, to where it was seen. */
static void add_prior(const struct iso_pose_options *options, const struct iso_rigid *pose,
                      double h[DOF * DOF], double g[DOF])
{
    /* A sum of squares over hundreds of vertices of about 2 mm rms; the prior counts as ten of
     * them. */
    double w = 10.0 * 4.0 / (options->nose_sigma_mm * options->nose_sigma_mm);
    struct iso_vec3 off = iso_sub(pose->translation_mm, options->nose_mm);
    const double r[3] = {off.x, off.y, off.z};
    for (int a = 0; a < 3; a++) {
        h[DOF * (a + 3) + a + 3] += w;
        g[a + 3] -= w * r[a];
    }
}

static void measure(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                    struct iso_pose_fit *fit)
{
    int count[4] = {0};
    double cost = 0.0;
    for (int i = 0; i < vertices->n; i++) {
        struct iso_vec3 point = iso_rigid_apply(&fit->camera_from_face, vertices->point_mm[i]);
        struct iso_vec3 normal = iso_mat3_apply(&fit->camera_from_face.rotation,
                                                vertices->normal[i]);
        double r = 0.0;
        enum meeting meeting = meet(frame, point, normal, &r);
        count[meeting]++;
        cost += meeting == MEASURED ? fmin(r * r, cost_limit_mm2) : 0.0;
    }
    int facing = vertices->n - count[TURNED_AWAY];
    fit->cost_mm2 = count[MEASURED] > 0 ? cost / count[MEASURED] : cost_limit_mm2;
    fit->coverage = facing > 0 ? (double)count[MEASURED] / facing : 0.0;
    fit->in_image = facing > 0 ? 1.0 - (double)count[OUTSIDE] / facing : 0.0;
}

int iso_pose_fit(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                 const struct iso_pose_options *options, const struct iso_rigid *start,
                 struct iso_pose_fit *out)
{
    struct iso_pose_fit fit = {.camera_from_face = *start};
    double fall = options->iterations > 1 ? pow(options->cutoff_last_mm / options->cutoff_first_mm,
                                                1.0 / (options->iterations - 1))
                                          : 1.0;
    double cutoff = options->cutoff_first_mm;
    for (int step = 0; step < options->iterations; step++, cutoff *= fall) {
        double h[DOF * DOF] = {0}, g[DOF] = {0};
        struct iso_rigid *pose = &fit.camera_from_face;
        if (accumulate(vertices, frame, pose, cutoff, h, g) < VERTICES_MIN) {
            return -ENODATA;
        }
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
    measure(vertices, frame, &fit);
    *out = fit;
    return 0;
}
