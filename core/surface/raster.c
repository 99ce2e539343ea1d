#include "core/surface/raster.h"

#include <stdbool.h>
#include <stddef.h>

/* A corner on the image plane. `q` is the value that is linear there: 1/z under perspective, z
 * itself under orthographic projection. */
struct corner {
    double u_px, v_px, q;
};

struct span {
    int column_from, column_to, row_from, row_to; /* inclusive */
};

void iso_raster_clear(const struct iso_raster *raster)
{
    const size_t n = (size_t)raster->width_px * (size_t)raster->height_px;
    for (size_t i = 0; i < n; i++) {
        raster->depth_mm[i] = 0.0f;
    }
    for (size_t i = 0; raster->triangle && i < n; i++) {
        raster->triangle[i] = -1;
    }
}

static struct corner corner_of(const struct iso_raster *raster, struct iso_vec3 p)
{
    const struct iso_camera *camera = &raster->camera;
    double u = camera->cx_px - raster->crop_x_px, v = camera->cy_px - raster->crop_y_px;
    if (camera->projection == ISO_ORTHOGRAPHIC) {
        return (struct corner){u + p.x / camera->pitch_mm, v + p.y / camera->pitch_mm, p.z};
    }
    const double q = 1.0 / p.z;
    return (struct corner){u + camera->fx_px * p.x * q, v + camera->fy_px * p.y * q, q};
}

/* Twice the signed area of (a, b, (u, v)). Swapping a and b negates it exactly, so that a pixel
 * centre next to an edge is inside at least one of the two triangles that share the edge. */
static double edge(const struct corner *a, const struct corner *b, double u, double v)
{
    return (a->u_px - u) * (b->v_px - v) - (b->u_px - u) * (a->v_px - v);
}

/* Conditional expressions, because fmin, fmax and ceil would be calls. */
static double smaller(double a, double b)
{
    return a < b ? a : b;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* The least whole number that is not less than x; x is not negative. */
static int round_up(double x)
{
    const int down = (int)x;
    return down + (down < x);
}

/* Pixels whose centres lie in the corners' bounding box, clipped to the plane; false if there are
 * none. */
static bool span_of(const struct iso_raster *raster, const struct corner c[3], struct span *out)
{
    const double u_min = smaller(c[0].u_px, smaller(c[1].u_px, c[2].u_px));
    const double u_max = larger(c[0].u_px, larger(c[1].u_px, c[2].u_px));
    const double v_min = smaller(c[0].v_px, smaller(c[1].v_px, c[2].v_px));
    const double v_max = larger(c[0].v_px, larger(c[1].v_px, c[2].v_px));
    double right = raster->width_px - 1, bottom = raster->height_px - 1;
    if (!(u_max >= 0.0 && v_max >= 0.0 && u_min <= right && v_min <= bottom)) {
        return false;
    }
    *out = (struct span){round_up(larger(u_min, 0.0)), (int)smaller(u_max, right),
                         round_up(larger(v_min, 0.0)), (int)smaller(v_max, bottom)};
    return true;
}

/* Draws one pixel, unless something nearer is there. w1, w2: the weights of the second and third
 * corner in the image. */
static void draw_pixel(const struct iso_raster *raster, size_t pixel, const struct corner c[3],
                       double w1, double w2, int32_t index)
{
    const bool perspective = raster->camera.projection != ISO_ORTHOGRAPHIC;
    const double q = (1.0 - w1 - w2) * c[0].q + w1 * c[1].q + w2 * c[2].q;
    const float z = (float)(perspective ? 1.0 / q : q);
    float old = raster->depth_mm[pixel];
    if (old > 0.0f && old <= z) {
        return;
    }
    raster->depth_mm[pixel] = z;
    if (raster->triangle) {
        raster->triangle[pixel] = index;
    }
    if (raster->weight) {
        raster->weight[pixel][0] = (float)(perspective ? w1 * c[1].q / q : w1);
        raster->weight[pixel][1] = (float)(perspective ? w2 * c[2].q / q : w2);
    }
}

static void draw_triangle(const struct iso_raster *raster, const struct corner c[3], int32_t index,
                          int cull)
{
    struct span span;
    /* v grows downwards. A triangle that is counter-clockwise seen from the camera has therefore a
     * negative area. */
    const double area = edge(&c[0], &c[1], c[2].u_px, c[2].v_px);
    const bool drawn = cull ? area < 0.0 : area < 0.0 || area > 0.0;
    if (!drawn || !span_of(raster, c, &span)) {
        return;
    }
    const double sign = area < 0.0 ? -1.0 : 1.0;
    for (int row = span.row_from; row <= span.row_to; row++) {
        for (int column = span.column_from; column <= span.column_to; column++) {
            const double e0 = sign * edge(&c[1], &c[2], column, row);
            double e1 = sign * edge(&c[2], &c[0], column, row);
            double e2 = sign * edge(&c[0], &c[1], column, row);
            if (e0 >= 0.0 && e1 >= 0.0 && e2 >= 0.0) {
                const size_t pixel = (size_t)row * (size_t)raster->width_px + (size_t)column;
                draw_pixel(raster, pixel, c, sign * e1 / area, sign * e2 / area, index);
            }
        }
    }
}

void iso_raster_triangle(const struct iso_raster *raster, const struct iso_vec3 corners_mm[3],
                         int32_t index, double near_mm, int cull)
{
    struct corner corners[3];
    for (int k = 0; k < 3; k++) {
        const struct iso_vec3 p = corners_mm[k];
        if (!(p.z >= near_mm && p.z > 0.0)) {
            return;
        }
        corners[k] = corner_of(raster, p);
    }
    draw_triangle(raster, corners, index, cull);
}

void iso_raster_triangles(const struct iso_raster *raster, const struct iso_vec3 *vertices_mm,
                          const uint32_t (*triangles)[3], int32_t n_triangles, int32_t first_index,
                          double near_mm, int cull)
{
    for (int32_t i = 0; i < n_triangles; i++) {
        const uint32_t *v = triangles[i];
        const struct iso_vec3 corners_mm[3] = {vertices_mm[v[0]], vertices_mm[v[1]],
                                               vertices_mm[v[2]]};
        iso_raster_triangle(raster, corners_mm, first_index + i, near_mm, cull);
    }
}
