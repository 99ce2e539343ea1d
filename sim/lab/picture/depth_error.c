#include "sim/lab/picture/depth_error.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "drivers/file/png.h"

static void paint(double true_mm, double measured_mm, double full_scale_mm, uint8_t rgb[3])
{
    const double share = fmin(fmax((measured_mm - true_mm) / full_scale_mm, -1.0), 1.0);
    if (!(measured_mm > 0.0)) {
        rgb[0] = rgb[1] = rgb[2] = true_mm > 0.0 ? 0 : 40;
        return;
    }
    const double fade = 200.0 * (1.0 - fabs(share));
    rgb[0] = (uint8_t)(share > 0.0 ? 255.0 - 55.0 * (1.0 - share) : fade);
    rgb[1] = (uint8_t)fade;
    rgb[2] = (uint8_t)(share < 0.0 ? 255.0 - 55.0 * (1.0 + share) : fade);
}

int sim_picture_depth_error(const struct sim_view *view, const struct iso_frame *frame,
                            double full_scale_mm, const char *path, struct iso_fault *fault)
{
    const size_t width = (size_t)frame->width_px, n = width * (size_t)frame->height_px;
    const size_t s = (size_t)view->supersample, view_width = (size_t)view->camera.width_px;
    uint8_t(*rgb)[3] = malloc(n * sizeof *rgb);
    if (!rgb) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    for (size_t i = 0; i < n; i++) {
        const size_t at = (i / width * s + s / 2) * view_width + i % width * s + s / 2;
        paint((double)view->depth_mm[at], (double)frame->depth_mm[i], full_scale_mm, rgb[i]);
    }
    struct iso_image image = {.width_px = frame->width_px,
                              .height_px = frame->height_px,
                              .pixel = ISO_PIXEL_RGB8,
                              .samples = rgb};
    const int error = iso_png_write(path, &image, 6, fault);
    free(rgb);
    return error;
}
