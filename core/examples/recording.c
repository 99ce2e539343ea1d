#include "recording.h"

#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_BYTES = 1024 };

static int failed(const char *path, const char *what)
{
    fprintf(stderr, "%s: %s\n", path, what);
    return -1;
}

int file_read(const char *path, void **bytes, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        return failed(path, "cannot be opened");
    }
    enum { LARGEST = 1 << 22 };
    *bytes = malloc(LARGEST);
    *size = *bytes ? fread(*bytes, 1, LARGEST, file) : 0;
    fclose(file);
    if (*size == 0) {
        free(*bytes);
        return failed(path, "cannot be read");
    }
    return 0;
}

/* Reads one line `key = value` of recording.ini. Lines that the examples do not need, such as the
 * headings of sections, are skipped. */
static void take_line(const char *line, struct recording *out)
{
    char key[32], value[32];
    if (sscanf(line, "%31[a-z0-9_] = %31s", key, value) != 2) {
        return;
    }
    struct iso_camera *camera = &out->camera;
    const struct {
        const char *key;
        double *value;
    } numbers[] = {{"fx_px", &camera->fx_px}, {"fy_px", &camera->fy_px}, {"cx_px", &camera->cx_px},
                   {"cy_px", &camera->cy_px}, {"k1", &camera->k1},       {"k2", &camera->k2},
                   {"k3", &camera->k3},       {"p1", &camera->p1},       {"p2", &camera->p2},
                   {"unit_mm", &out->unit_mm}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (strcmp(key, numbers[i].key) == 0) {
            *numbers[i].value = strtod(value, NULL);
        }
    }
    if (strcmp(key, "width_px") == 0) {
        camera->width_px = atoi(value);
    } else if (strcmp(key, "height_px") == 0) {
        camera->height_px = atoi(value);
    } else if (strcmp(key, "sensor") == 0) {
        snprintf(out->sensor, sizeof out->sensor, "%.15s", value);
    }
}

int recording_open(const char *directory, struct recording *out)
{
    char path[PATH_BYTES], line[256];
    memset(out, 0, sizeof *out);
    snprintf(out->directory, sizeof out->directory, "%s", directory);
    snprintf(path, sizeof path, "%s/recording.ini", out->directory);
    FILE *file = fopen(path, "r");
    if (!file) {
        return failed(path, "cannot be opened");
    }
    while (fgets(line, sizeof line, file)) {
        take_line(line, out);
    }
    fclose(file);
    out->camera.projection = ISO_PINHOLE;
    struct iso_fault fault = {.text = ""};
    return iso_camera_check(&out->camera, &fault) ? failed(path, fault.text) : 0;
}

/* Reads a PNG of 16-bit grey into a frame of the same size. libpng reports errors by longjmp. */
static int read_png(FILE *file, double unit_mm, struct iso_frame *frame)
{
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_read_struct(&png, &info, NULL);
        return -1;
    }
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_SWAP_ENDIAN,
                 NULL); /* samples in the order of this machine */
    int error = -1;
    if (png_get_image_width(png, info) == (png_uint_32)frame->width_px &&
        png_get_image_height(png, info) == (png_uint_32)frame->height_px &&
        png_get_bit_depth(png, info) == 16 &&
        png_get_color_type(png, info) == PNG_COLOR_TYPE_GRAY) {
        png_bytepp rows = png_get_rows(png, info);
        float *depth_mm = frame->depth_mm;
        for (int row = 0; row < frame->height_px; row++) {
            for (int column = 0; column < frame->width_px; column++) {
                unsigned short count;
                memcpy(&count, rows[row] + 2 * column, sizeof count);
                *depth_mm++ = (float)(count * unit_mm);
            }
        }
        error = 0;
    }
    png_destroy_read_struct(&png, &info, NULL);
    return error;
}

/* Finds the time and the file of a frame in depth.txt. Returns 1; 0 after the last frame; -1 with a
 * line on standard error. */
static int find_frame(const struct recording *recording, int index, double *seconds, char name[256])
{
    char path[PATH_BYTES], line[512];
    snprintf(path, sizeof path, "%s/depth.txt", recording->directory);
    FILE *file = fopen(path, "r");
    if (!file) {
        return failed(path, "cannot be opened");
    }
    int found = 0;
    while (!found && fgets(line, sizeof line, file)) {
        found = sscanf(line, "%lf %255s", seconds, name) == 2 && index-- == 0;
    }
    fclose(file);
    return found;
}

int recording_read(const struct recording *recording, int index, struct iso_frame **out)
{
    double seconds = 0.0;
    char name[256], path[PATH_BYTES];
    const int found = find_frame(recording, index, &seconds, name);
    if (found <= 0) {
        return found;
    }
    snprintf(path, sizeof path, "%s/%s", recording->directory, name);
    const struct iso_camera *camera = &recording->camera;
    if (iso_frame_new(camera, camera->width_px, camera->height_px, false, out)) {
        return failed(path, "out of memory");
    }
    (*out)->t_ns = (int64_t)(seconds * 1e9);
    (*out)->sequence = (uint64_t)index;
    FILE *file = fopen(path, "rb");
    const int error = file ? read_png(file, recording->unit_mm, *out) : -1;
    if (file) {
        fclose(file);
    }
    if (error) {
        iso_frame_free(*out);
        return failed(path, "is not a 16-bit grey PNG of the camera's size");
    }
    return 1;
}
