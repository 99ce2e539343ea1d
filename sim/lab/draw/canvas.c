#include "sim/lab/draw/canvas.h"

#include <errno.h>
#include <stdlib.h>

static void paint_background(struct sim_canvas *canvas, struct sim_colour top,
                             struct sim_colour bottom)
{
    for (int y = 0; y < canvas->height; y++) {
        const float v = ((float)y + 0.5f) / (float)canvas->height;
        for (int x = 0; x < canvas->width; x++) {
            const float u = ((float)x + 0.5f) / (float)canvas->width;
            const float off = (u - 0.5f) * (u - 0.5f) + (v - 0.5f) * (v - 0.5f); /* 0..0.5 */
            canvas->sample[(long)y * canvas->width + x] = sim_colour_scale(
                1.0f - 0.6f * off, sim_colour_mix(top, bottom, v));
        }
    }
}

int sim_canvas_new(int width_px, int height_px, struct sim_colour top, struct sim_colour bottom,
                   struct sim_canvas **out)
{
    enum { SIDE_MAX = 4096 };
    if (width_px < 1 || height_px < 1 || width_px > SIDE_MAX || height_px > SIDE_MAX) {
        return -EINVAL;
    }
    struct sim_canvas *canvas = calloc(1, sizeof *canvas);
    if (!canvas) {
        return -ENOMEM;
    }
    canvas->width = width_px * SIM_CANVAS_SUPERSAMPLING;
    canvas->height = height_px * SIM_CANVAS_SUPERSAMPLING;
    canvas->sample = calloc((size_t)canvas->width * (size_t)canvas->height, sizeof *canvas->sample);
    if (!canvas->sample) {
        free(canvas);
        return -ENOMEM;
    }
    paint_background(canvas, top, bottom);
    *out = canvas;
    return 0;
}

void sim_canvas_free(struct sim_canvas *canvas)
{
    if (canvas) {
        free(canvas->sample);
        free(canvas);
    }
}

static uint32_t pixel_of(const struct sim_canvas *canvas, int column, int row)
{
    struct sim_colour sum = {0.0f, 0.0f, 0.0f};
    for (int j = 0; j < SIM_CANVAS_SUPERSAMPLING; j++) {
        for (int i = 0; i < SIM_CANVAS_SUPERSAMPLING; i++) {
            const long y = (long)row * SIM_CANVAS_SUPERSAMPLING + j;
            const struct sim_colour *s =
                &canvas->sample[y * canvas->width + (long)column * SIM_CANVAS_SUPERSAMPLING + i];
            sum.r += s->r;
            sum.g += s->g;
            sum.b += s->b;
        }
    }
    struct sim_colour mean = sim_colour_scale(
        1.0f / (SIM_CANVAS_SUPERSAMPLING * SIM_CANVAS_SUPERSAMPLING), sum);
    return (uint32_t)sim_colour_byte(mean.r) << 16 | (uint32_t)sim_colour_byte(mean.g) << 8 |
           (uint32_t)sim_colour_byte(mean.b);
}

cairo_surface_t *sim_canvas_surface(const struct sim_canvas *canvas)
{
    const int width_px = canvas->width / SIM_CANVAS_SUPERSAMPLING;
    const int height_px = canvas->height / SIM_CANVAS_SUPERSAMPLING;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px);
    if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
        return surface;
    }
    cairo_surface_flush(surface);
    unsigned char *bytes = cairo_image_surface_get_data(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int row = 0; row < height_px; row++) {
        uint32_t *pixels = (uint32_t *)(void *)(bytes + (long)row * stride);
        for (int column = 0; column < width_px; column++) {
            pixels[column] = pixel_of(canvas, column, row);
        }
    }
    cairo_surface_mark_dirty(surface);
    return surface;
}
