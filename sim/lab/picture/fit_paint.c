#include "sim/lab/picture/fit_paint.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/lab/picture/relief.h"

struct sim_colour *sim_fit_grey_new(const struct iso_frame *frame)
{
    const double fade_mm = 900.0; /* distance from the nearest point to the darkest place */
    const size_t n = (size_t)frame->width_px * (size_t)frame->height_px;
    struct sim_colour *grey = calloc(n, sizeof *grey);
    const struct sim_colour hole = sim_colour_hex(0x0c1a33);
    const double nearest_mm = sim_relief_nearest_mm(frame);
    for (size_t i = 0; grey && i < n; i++) {
        const int column = (int)(i % (size_t)frame->width_px),
                  row = (int)(i / (size_t)frame->width_px);
        const double depth = (double)frame->depth_mm[i];
        if (depth <= 0.0) {
            grey[i] = hole;
            continue;
        }
        float light = sim_relief(frame, column, row, sim_relief_reach_px(frame, depth));
        light *= light; /* relief is meant for sRGB */
        light *= (float)(1.0 - 0.8 * fmin((depth - nearest_mm) / fade_mm, 1.0));
        grey[i] = sim_colour_scale(0.8f * light, (struct sim_colour){1.0f, 1.0f, 1.0f});
    }
    return grey;
}

void sim_fit_paint_frame(struct sim_canvas *canvas, const struct iso_frame *frame,
                         const struct sim_colour *grey, struct sim_fit_window window)
{
    for (int y = 0; y < canvas->height; y++) {
        const int row = (int)floor(window.y + (y + 0.5) * window.side / canvas->height);
        for (int x = 0; x < canvas->width; x++) {
            const int column = (int)floor(window.x + (x + 0.5) * window.side / canvas->width);
            if (row >= 0 && row < frame->height_px && column >= 0 && column < frame->width_px) {
                sim_canvas_blend(canvas, x, y, grey[(long)row * frame->width_px + column], 1.0f);
            }
        }
    }
}

/* The frame's camera, scaled and moved so that the window fills the samples of a panel. */
static struct iso_camera camera_of(const struct iso_frame *frame, struct sim_fit_window window)
{
    const double zoom = SIM_FIT_SAMPLES / window.side;
    struct iso_camera camera = frame->camera;
    camera.width_px = camera.height_px = SIM_FIT_SAMPLES;
    camera.fx_px *= zoom;
    camera.fy_px *= zoom;
    camera.pitch_mm /= zoom;
    camera.cx_px = (camera.cx_px - frame->crop_x_px + 0.5 - window.x) * zoom - 0.5;
    camera.cy_px = (camera.cy_px - frame->crop_y_px + 0.5 - window.y) * zoom - 0.5;
    return camera;
}

int sim_fit_head_new(const struct sim_fit_view *view, struct sim_fit_window window,
                     struct sim_fit_head *out)
{
    enum { PLANES = 4 }; /* depth, triangle, two weights */
    const size_t n = (size_t)SIM_FIT_SAMPLES * SIM_FIT_SAMPLES;
    out->storage = calloc(PLANES * n, sizeof *out->storage);
    if (!out->storage) {
        return -ENOMEM;
    }
    out->raster = (struct iso_raster){
        .camera = camera_of(view->frame, window),
        .width_px = SIM_FIT_SAMPLES,
        .height_px = SIM_FIT_SAMPLES,
        .depth_mm = (float *)out->storage,
        .triangle = (int32_t *)(out->storage + n),
        .weight = (float(*)[2])(out->storage + 2 * n),
    };
    iso_raster_clear(&out->raster);
    iso_raster_triangles(&out->raster, view->vertices_mm, view->triangles,
                         (int32_t)view->n_triangles, 0, 1.0, 1);
    return 0;
}

/* The brightness of a triangle under a light at the upper left. */
static float triangle_light(const struct sim_fit_view *view, int32_t triangle)
{
    const uint32_t *c = view->triangles[triangle];
    struct iso_vec3 a = view->vertices_mm[c[0]];
    struct iso_vec3 normal = iso_unit(
        iso_cross(iso_sub(view->vertices_mm[c[1]], a), iso_sub(view->vertices_mm[c[2]], a)));
    return (float)fmax(0.12, iso_dot(normal, iso_unit(iso_vec3(-1.0, -1.0, -2.0))));
}

void sim_fit_paint_mesh(struct sim_canvas *canvas, const struct sim_fit_view *view,
                        const struct sim_fit_head *head)
{
    const struct sim_colour base = sim_colour_hex(0x8fb8ff), edge = sim_colour_hex(0x10306b);
    for (long i = 0; i < (long)SIM_FIT_SAMPLES * SIM_FIT_SAMPLES; i++) {
        const int32_t triangle = head->raster.triangle[i];
        if (triangle >= 0) {
            const float *w = head->raster.weight[i];
            const float nearest = fminf(fminf(w[0], w[1]), 1.0f - w[0] - w[1]);
            const bool on_edge = nearest < 0.05f;
            struct sim_colour colour = sim_colour_scale(triangle_light(view, triangle), base);
            const int x = (int)(i % SIM_FIT_SAMPLES), y = (int)(i / SIM_FIT_SAMPLES);
            sim_canvas_blend(canvas, x, y, on_edge ? edge : colour, 0.6f);
        }
    }
}

/* The interpolated residual colour in a triangle; grey towards unmeasured corners. */
static struct sim_colour residual_colour(const struct sim_fit_view *view, int32_t triangle,
                                         const float weight[2])
{
    const struct sim_colour unknown = sim_colour_hex(0x4a4d55);
    const float share[3] = {1.0f - weight[0] - weight[1], weight[0], weight[1]};
    float sum_mm = 0.0f, measured = 0.0f;
    for (int k = 0; k < 3; k++) {
        const uint32_t corner = view->triangles[triangle][k];
        if (view->measured[corner]) {
            sum_mm += share[k] * view->residual_mm[corner];
            measured += share[k];
        }
    }
    if (measured <= 0.0f) {
        return unknown;
    }
    const double value = 0.5 + 0.5 * (double)(sum_mm / measured) / SIM_FIT_RESIDUAL_LIMIT_MM;
    return sim_colour_mix(unknown, sim_colour_difference(value), measured);
}

void sim_fit_paint_residuals(struct sim_canvas *canvas, const struct sim_fit_view *view,
                             const struct sim_fit_head *head)
{
    for (long i = 0; i < (long)SIM_FIT_SAMPLES * SIM_FIT_SAMPLES; i++) {
        const int32_t triangle = head->raster.triangle[i];
        if (triangle >= 0) {
            const float light = 0.65f + 0.35f * triangle_light(view, triangle);
            struct sim_colour colour = residual_colour(view, triangle, head->raster.weight[i]);
            sim_canvas_blend(canvas, (int)(i % SIM_FIT_SAMPLES), (int)(i / SIM_FIT_SAMPLES),
                             sim_colour_scale(light, colour), 1.0f);
        }
    }
}
