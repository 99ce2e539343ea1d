#include "sim/lab/methods/reflectance.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { REACH_MAX = 128 }; /* pixels; enough for 0.5 mm a pixel */

static const double same_surface_mm = 10.0;
static const double cosine_min = 0.2; /* a surface seen at a flat angle gives little information */
static const double fine_mm = 2.5, around_mm = 15.0;
static const double least = 0.25, most = 4.0;

/* A plane of the grid with holes. Weight is 1 where there is a value; both are 0 in holes. */
struct plane {
    int side;
    double *value, *weight; /* [side * side] */
    double *scratch;        /* [2][side * side] */
};

/* Outward normal of the face at a pixel by central differences; false at the domain's edge. */
static bool normal_at(const struct sim_scan *face, int column, int row, struct iso_vec3 *out)
{
    if (column < 1 || row < 1 || column + 1 >= face->side || row + 1 >= face->side) {
        return false;
    }
    struct iso_vec3 across = iso_sub(sim_scan_point(face, column + 1, row),
                                     sim_scan_point(face, column - 1, row));
    struct iso_vec3 up = iso_sub(sim_scan_point(face, column, row - 1),
                                 sim_scan_point(face, column, row + 1));
    struct iso_vec3 normal = iso_cross(across, up);
    const double length = iso_norm(normal);
    if (!(length > 0.0)) {
        return false; /* also for NaN */
    }
    *out = iso_scale(1.0 / length, normal);
    return true;
}

/* Mean of the image around a point of the camera frame, over pixels at its depth; NAN if there are
 * none. */
static double seen(const struct iso_frame *frame, struct iso_vec3 at, double spacing_mm)
{
    double u, v, sum = 0.0;
    if (!iso_camera_project(&frame->camera, at, &u, &v)) {
        return NAN;
    }
    u -= frame->crop_x_px;
    v -= frame->crop_y_px;
    const double half = fmax(0.5, 0.5 * spacing_mm / iso_camera_pixel_mm(&frame->camera, at.z));
    int n = 0, left = (int)fmax(0.0, ceil(u - half)), top = (int)fmax(0.0, ceil(v - half));
    for (int row = top; row <= v + half && row < frame->height_px; row++) {
        for (int column = left; column <= u + half && column < frame->width_px; column++) {
            const size_t i = (size_t)row * (size_t)frame->width_px + (size_t)column;
            if (fabs((double)frame->depth_mm[i] - at.z) <= same_surface_mm) {
                sum += (double)frame->intensity[i];
                n++;
            }
        }
    }
    return n > 0 ? sum / n : NAN;
}

/* Steps 1 and 2 at one pixel; NAN where the image is unknown. */
static double unlit(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                    const struct sim_scan *face, int column, int row)
{
    struct iso_vec3 normal;
    if (!face->measured[row * face->side + column] || !normal_at(face, column, row, &normal)) {
        return NAN;
    }
    struct iso_vec3 at = iso_rigid_apply(camera_from_face, sim_scan_point(face, column, row));
    const bool pinhole = frame->camera.projection == ISO_PINHOLE;
    const double range = iso_norm(at);
    struct iso_vec3 sight = pinhole ? iso_scale(-1.0 / range, at) : iso_vec3(0.0, 0.0, -1.0);
    const double cosine = iso_dot(iso_mat3_apply(&camera_from_face->rotation, normal), sight);
    if (cosine < cosine_min) {
        return NAN;
    }
    return seen(frame, at, face->spacing_mm) / cosine * (pinhole ? range * range : 1.0);
}

/* Half of a Gaussian, cut at three sigma. */
struct kernel {
    int reach;
    double value[REACH_MAX + 1];
};

static struct kernel gaussian(double sigma_px)
{
    struct kernel k = {.reach = (int)fmin(ceil(3.0 * sigma_px), REACH_MAX)};
    for (int d = 0; d <= k.reach; d++) {
        k.value[d] = exp(-0.5 * d * d / (sigma_px * sigma_px));
    }
    return k;
}

/* One direction of the Gaussian over a plane. */
static void blur_lines(const struct plane *p, const double *from, double *to,
                       const struct kernel *kernel, int stride, int across)
{
    const int reach = kernel->reach;
    for (int line = 0; line < p->side; line++) {
        for (int k = 0; k < p->side; k++) {
            double sum = 0.0;
            for (int d = -reach; d <= reach; d++) {
                if (k + d >= 0 && k + d < p->side) {
                    sum += kernel->value[abs(d)] * from[line * across + (k + d) * stride];
                }
            }
            to[line * across + k * stride] = sum;
        }
    }
}

/* The Gaussian mean around each pixel over the known values (normalised convolution: Knutsson
 * and Westin 1993); 0 where no value is known. */
static void mean_around(const struct plane *p, double sigma_px, double *out)
{
    const size_t n = (size_t)p->side * (size_t)p->side;
    double *line = p->scratch, *weight = p->scratch + n;
    const struct kernel kernel = gaussian(sigma_px);
    blur_lines(p, p->weight, line, &kernel, 1, p->side);
    blur_lines(p, line, weight, &kernel, p->side, 1);
    blur_lines(p, p->value, line, &kernel, 1, p->side);
    blur_lines(p, line, out, &kernel, p->side, 1);
    for (size_t i = 0; i < n; i++) {
        out[i] = weight[i] > 0.0 ? out[i] / weight[i] : 0.0;
    }
}

static void fill(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                 struct sim_scan *face, const struct plane *p, double *fine, double *around)
{
    const size_t n = sim_scan_pixels(face);
    for (size_t i = 0; i < n; i++) {
        const double r = unlit(frame, camera_from_face, face, (int)i % face->side,
                               (int)i / face->side);
        p->weight[i] = isnan(r) ? 0.0 : 1.0;
        p->value[i] = isnan(r) ? 0.0 : r;
    }
    mean_around(p, fine_mm / face->spacing_mm, fine);
    mean_around(p, around_mm / face->spacing_mm, around);
    for (size_t i = 0; i < n; i++) {
        const bool known = p->weight[i] > 0.0 && around[i] > 0.0;
        face->reflectance[i] = known ? (float)fmin(fmax(fine[i] / around[i], least), most) : 1.0f;
    }
}

int sim_reflectance_measure(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                            struct sim_scan *face)
{
    if (!frame->intensity) {
        return 0;
    }
    const size_t n = sim_scan_pixels(face);
    double *planes = calloc(6 * n, sizeof *planes);
    float *reflectance = calloc(n, sizeof *reflectance);
    if (!planes || !reflectance) {
        free(planes);
        free(reflectance);
        return -ENOMEM;
    }
    const struct plane p = {face->side, planes, planes + n, planes + 2 * n};
    face->reflectance = reflectance;
    fill(frame, camera_from_face, face, &p, planes + 4 * n, planes + 5 * n);
    explicit_bzero(planes, 6 * n * sizeof *planes);
    free(planes);
    return 0;
}
