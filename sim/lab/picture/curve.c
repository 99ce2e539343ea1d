/* Curves and dots on the surface of a scene. */
#include <math.h>

#include "sim/lab/picture/scene_data.h"

/* Points up to this distance behind the surface are still visible, because curves lie on the
 * surface. */
static const double on_surface_mm = 2.5;

static double sample_width(double px)
{
    return px * SIM_CANVAS_SUPERSAMPLING;
}

struct spot {
    double x, y, z_mm; /* samples, depth */
};

static struct spot project(const struct sim_scene *scene, struct iso_vec3 point_mm)
{
    const struct iso_camera *camera = &scene->raster.camera;
    struct iso_vec3 p = iso_rigid_apply(&scene->camera_from_face, point_mm);
    return (struct spot){camera->cx_px + camera->fx_px * p.x / p.z,
                         camera->cy_px + camera->fy_px * p.y / p.z, p.z};
}

static bool visible(const struct sim_scene *scene, int x, int y, double z_mm)
{
    const double depth = (double)scene->raster.depth_mm[(long)y * scene->raster.width_px + x];
    return depth == 0.0 || z_mm < depth + on_surface_mm;
}

/* Whether the middle of a spot is visible. */
static bool spot_visible(const struct sim_scene *scene, struct spot s)
{
    const int x = (int)lrint(s.x), y = (int)lrint(s.y);
    return x >= 0 && y >= 0 && x < scene->raster.width_px && y < scene->raster.height_px &&
           visible(scene, x, y, s.z_mm);
}

/* Paints the samples within `radius` of the segment from a to b. */
static void paint_segment(const struct sim_scene *scene, struct spot a, struct spot b,
                          double radius, struct sim_colour colour)
{
    const int x0 = (int)fmax(0.0, ceil(fmin(a.x, b.x) - radius));
    const int y0 = (int)fmax(0.0, ceil(fmin(a.y, b.y) - radius));
    const int x1 = (int)fmin(scene->raster.width_px - 1, floor(fmax(a.x, b.x) + radius));
    const int y1 = (int)fmin(scene->raster.height_px - 1, floor(fmax(a.y, b.y) + radius));
    const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            double t = squared > 0.0 ? ((x - a.x) * dx + (y - a.y) * dy) / squared : 0.0;
            t = fmin(fmax(t, 0.0), 1.0);
            const double distance = hypot(x - a.x - t * dx, y - a.y - t * dy);
            if (distance <= radius) {
                sim_canvas_blend(scene->canvas, x, y, colour, 1.0f);
            }
        }
    }
}

static struct iso_vec3 catmull_rom(const struct iso_vec3 p[4], double t)
{
    const double t2 = t * t, t3 = t2 * t;
    struct iso_vec3 sum = iso_scale(-0.5 * t3 + t2 - 0.5 * t, p[0]);
    sum = iso_madd(sum, 1.5 * t3 - 2.5 * t2 + 1.0, p[1]);
    sum = iso_madd(sum, -1.5 * t3 + 2.0 * t2 + 0.5 * t, p[2]);
    return iso_madd(sum, 0.5 * t3 - 0.5 * t2, p[3]);
}

void sim_scene_curve(const struct sim_scene *scene, const struct iso_vec3 *points_mm,
                     const float *weight, int n, struct sim_colour colour, double width_px)
{
    enum { PIECES = 12 };
    for (int i = 0; i < n; i++) {
        if (weight[i] <= 0.0f || weight[(i + 1) % n] <= 0.0f) {
            continue;
        }
        struct iso_vec3 p[4];
        for (int k = 0; k < 4; k++) {
            const int index = (i + k - 1 + n) % n;
            const int end = k == 0 ? i : (i + 1) % n; /* replaces a neighbour that is missing */
            p[k] = points_mm[weight[index] > 0.0f ? index : end];
        }
        struct spot before = project(scene, p[1]);
        for (int piece = 1; piece <= PIECES; piece++) {
            struct spot after = project(scene, catmull_rom(p, (double)piece / PIECES));
            if (spot_visible(scene, before) && spot_visible(scene, after)) {
                paint_segment(scene, before, after, 0.5 * sample_width(width_px), colour);
            }
            before = after;
        }
    }
}

void sim_scene_dot(const struct sim_scene *scene, struct iso_vec3 point_mm,
                   struct sim_colour colour, double radius_px)
{
    struct spot spot = project(scene, point_mm);
    if (spot_visible(scene, spot)) {
        const struct sim_colour dark = {0.01f, 0.01f, 0.012f};
        paint_segment(scene, spot, spot, sample_width(radius_px + 1.2), dark);
        paint_segment(scene, spot, spot, sample_width(radius_px), colour);
    }
}
