#include "drivers/recording/recording_ini.h"

#include <errno.h>

#include "drivers/file/text.h"

/* Prints a coefficient of the distortion. A coefficient that is 0 may be left out. */
static void print_distortion(FILE *stream, const char *key, double value)
{
    if (value != 0.0) {
        iso_text_print_number(stream, key, value);
    }
}

static void print_pinhole(FILE *stream, const struct iso_camera *camera)
{
    iso_text_print_number(stream, "fx_px", camera->fx_px);
    iso_text_print_number(stream, "fy_px", camera->fy_px);
    print_distortion(stream, "k1", camera->k1);
    print_distortion(stream, "k2", camera->k2);
    print_distortion(stream, "k3", camera->k3);
    print_distortion(stream, "p1", camera->p1);
    print_distortion(stream, "p2", camera->p2);
}

int sim_recording_ini_print(FILE *stream, const struct iso_recording_meta *meta)
{
    const struct iso_camera *camera = &meta->camera;
    const bool pinhole = camera->projection == ISO_PINHOLE;
    (void)fprintf(stream, "[recording]\nformat = 1\nsensor = %s\n\n[depth]\n", meta->sensor);
    (void)fprintf(stream, "projection = %s\n", pinhole ? "pinhole" : "orthographic");
    (void)fprintf(stream, "width_px = %d\nheight_px = %d\n", camera->width_px, camera->height_px);
    if (pinhole) {
        print_pinhole(stream, camera);
    } else {
        iso_text_print_number(stream, "pitch_mm", camera->pitch_mm);
    }
    iso_text_print_number(stream, "cx_px", camera->cx_px);
    iso_text_print_number(stream, "cy_px", camera->cy_px);
    if (meta->nominal) {
        (void)fputs("nominal = yes\n", stream);
    }
    iso_text_print_number(stream, "unit_mm", meta->unit_mm);
    return ferror(stream) ? -EIO : 0;
}
