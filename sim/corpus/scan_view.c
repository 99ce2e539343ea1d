#include "sim/corpus/scan_view.h"

#include <errno.h>
#include <stdlib.h>

#include "core/surface/raster.h"
#include "sim/base/spread.h"

static const double nearest_mm = 600.0, near_plane_mm = 50.0;
static const double texas_pitch_mm = 0.32;

const struct iso_camera sim_scan_camera = {
    .projection = ISO_PINHOLE,
    .width_px = 640,
    .height_px = 480,
    .fx_px = 900.0,
    .fy_px = 900.0,
    .cx_px = 319.5,
    .cy_px = 239.5,
};

/* Moves the scan into the camera's frame: y down, z away, and a shift. */
static int place(struct iso_mesh *scan)
{
    const size_t n = (size_t)scan->n_vertices;
    double *values = calloc(n, sizeof *values);
    if (!values) {
        return -ENOMEM;
    }
    double middle[3];
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < n; i++) {
            const struct iso_vec3 *p = &scan->vertices_mm[i];
            const double coordinates[] = {p->x, p->y, p->z};
            values[i] = coordinates[k];
        }
        sim_sort(values, n);
        middle[k] = values[sim_quantile_index(n, k == 2 ? 99 : 50)];
    }
    free(values);
    for (size_t i = 0; i < n; i++) {
        struct iso_vec3 *p = &scan->vertices_mm[i];
        *p = iso_vec3(p->x - middle[0], middle[1] - p->y, nearest_mm + middle[2] - p->z);
    }
    return 0;
}

int sim_scan_view(struct iso_mesh *scan, struct iso_frame **out)
{
    const struct iso_camera *camera = &sim_scan_camera;
    struct iso_frame *frame = NULL;
    int error = place(scan);
    if (!error) {
        error = iso_frame_new(camera, camera->width_px, camera->height_px, false, &frame);
    }
    if (error) {
        return error;
    }
    const struct iso_raster raster = {
        .camera = *camera,
        .width_px = camera->width_px,
        .height_px = camera->height_px,
        .depth_mm = frame->depth_mm,
    };
    iso_raster_clear(&raster);
    /* Both sides are drawn, because scanners order the corners differently. Indices are not
     * negative. */
    iso_raster_triangles(&raster, scan->vertices_mm, (const uint32_t(*)[3])scan->triangles,
                         scan->n_triangles, 0, near_plane_mm, 0);
    *out = frame;
    return 0;
}

/* Luma of a sample, 0..1 (Rec. 709). */
static float brightness(const struct iso_image *portrait, size_t i)
{
    const uint8_t *samples = portrait->samples;
    if (portrait->pixel == ISO_PIXEL_GREY8) {
        return (float)samples[i] / 255.0f;
    }
    const uint8_t *rgb = &samples[3 * i];
    return (0.2126f * (float)rgb[0] + 0.7152f * (float)rgb[1] + 0.0722f * (float)rgb[2]) / 255.0f;
}

int sim_scan_of_range(const struct iso_image *range, const struct iso_image *portrait,
                      double level_mm, struct iso_frame **out)
{
    const bool fits = range->pixel == ISO_PIXEL_GREY8 && level_mm > 0.0 &&
                      (!portrait ||
                       ((portrait->pixel == ISO_PIXEL_GREY8 || portrait->pixel == ISO_PIXEL_RGB8) &&
                        portrait->width_px == range->width_px &&
                        portrait->height_px == range->height_px));
    if (!fits) {
        return -EINVAL;
    }
    const struct iso_camera camera = {
        .projection = ISO_ORTHOGRAPHIC,
        .width_px = range->width_px,
        .height_px = range->height_px,
        .pitch_mm = texas_pitch_mm,
        .cx_px = (range->width_px - 1) / 2.0,
        .cy_px = (range->height_px - 1) / 2.0,
    };
    struct iso_frame *frame = NULL;
    const int error = iso_frame_new(&camera, range->width_px, range->height_px, portrait != NULL,
                                    &frame);
    const uint8_t *levels = range->samples;
    const size_t n = (size_t)range->width_px * (size_t)range->height_px;
    for (size_t i = 0; i < n && !error; i++) {
        frame->depth_mm[i] = levels[i] > 0 ? (float)(nearest_mm + level_mm * (255 - levels[i]))
                                           : 0.0f;
        if (portrait) {
            frame->intensity[i] = brightness(portrait, i);
        }
    }
    if (!error) {
        *out = frame;
    }
    return error;
}
