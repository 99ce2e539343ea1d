#include "isotherm/camera.h"

#include <errno.h>
#include <stddef.h>

#include "core/base/fault.h"
#include "core/frame/distortion.h"

static bool in_range(double value, double low, double high)
{
    return value >= low && value <= high; /* false for NaN */
}

/* NULL, or what is wrong with the intrinsics of one projection. */
static const char *pinhole_fault(const struct iso_camera *c)
{
    if (!in_range(c->fx_px, 16.0, 65536.0) || !in_range(c->fy_px, 16.0, 65536.0)) {
        return "focal length must be 16..65536 px";
    }
    const double distortion[] = {c->k1, c->k2, c->k3, c->p1, c->p2};
    for (size_t i = 0; i < sizeof distortion / sizeof distortion[0]; i++) {
        if (!in_range(distortion[i], -10.0, 10.0)) {
            return "distortion must be -10..10";
        }
    }
    return NULL;
}

static const char *camera_fault(const struct iso_camera *c)
{
    if (!in_range(c->width_px, 1, 8192) || !in_range(c->height_px, 1, 8192)) {
        return "image size must be 1..8192 px";
    }
    if (!in_range(c->cx_px, -c->width_px, 2.0 * c->width_px) ||
        !in_range(c->cy_px, -c->height_px, 2.0 * c->height_px)) {
        return "principal point lies more than one image away";
    }
    switch (c->projection) {
    case ISO_PINHOLE:
        return pinhole_fault(c);
    case ISO_ORTHOGRAPHIC:
        return in_range(c->pitch_mm, 0.01, 100.0) ? NULL : "pitch must be 0.01..100 mm";
    case ISO_PROJECTION_NONE:
        break;
    }
    return "projection is neither pinhole nor orthographic";
}

int iso_camera_check(const struct iso_camera *camera, struct iso_fault *fault)
{
    const char *text = camera_fault(camera);
    return text ? iso_fault_set(fault, -EINVAL, "%s", text) : 0;
}

/* Brown's model on normalised coordinates. */
static void distort(const struct iso_camera *c, double x, double y, double *xd, double *yd)
{
    const double r2 = x * x + y * y;
    const double radial = 1.0 + r2 * (c->k1 + r2 * (c->k2 + r2 * c->k3));
    *xd = x * radial + 2.0 * c->p1 * x * y + c->p2 * (r2 + 2.0 * x * x);
    *yd = y * radial + c->p1 * (r2 + 2.0 * y * y) + 2.0 * c->p2 * x * y;
}

/* Solves distort(x) = xd by iterating x = xd - (distort(x) - x). */
static void undistort(const struct iso_camera *c, double *x, double *y)
{
    enum { ITERATIONS_MAX = 100 };
    double xd = *x, yd = *y;
    for (int i = 0; i < ITERATIONS_MAX; i++) {
        double xe, ye;
        distort(c, *x, *y, &xe, &ye);
        double dx = xd - xe, dy = yd - ye;
        *x += dx;
        *y += dy;
        if (fabs(dx) * c->fx_px < 1e-6 && fabs(dy) * c->fy_px < 1e-6) {
            break;
        }
    }
}

struct iso_vec3 iso_camera_back_project(const struct iso_camera *camera, double u_px, double v_px,
                                        double z_mm)
{
    double du = u_px - camera->cx_px, dv = v_px - camera->cy_px;
    if (camera->projection == ISO_ORTHOGRAPHIC) {
        return iso_vec3(du * camera->pitch_mm, dv * camera->pitch_mm, z_mm);
    }
    double x = du / camera->fx_px, y = dv / camera->fy_px;
    if (iso_camera_is_distorted(camera)) {
        undistort(camera, &x, &y);
    }
    return iso_vec3(x * z_mm, y * z_mm, z_mm);
}

bool iso_camera_project(const struct iso_camera *camera, struct iso_vec3 p, double *u_px,
                        double *v_px)
{
    if (camera->projection == ISO_ORTHOGRAPHIC) {
        *u_px = camera->cx_px + p.x / camera->pitch_mm;
        *v_px = camera->cy_px + p.y / camera->pitch_mm;
        return true;
    }
    if (!(p.z > 0.0)) {
        return false;
    }
    double x = p.x / p.z, y = p.y / p.z;
    if (iso_camera_is_distorted(camera)) {
        distort(camera, x, y, &x, &y);
    }
    *u_px = camera->cx_px + camera->fx_px * x;
    *v_px = camera->cy_px + camera->fy_px * y;
    return true;
}

double iso_camera_pixel_mm(const struct iso_camera *camera, double z_mm)
{
    return camera->projection == ISO_ORTHOGRAPHIC ? camera->pitch_mm : z_mm / camera->fx_px;
}
