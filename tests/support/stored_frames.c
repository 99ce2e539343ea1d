#include "tests/support/stored_frames.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/file/png.h"
#include "tests/support/scratch.h"

const char stored_ini[] = "[recording]\n"
                          "format = 1\n"
                          "sensor = astra\n"
                          "\n"
                          "[depth]\n"
                          "projection = pinhole\n"
                          "width_px = 7\n"
                          "height_px = 5\n"
                          "fx_px = 570.5\n"
                          "fy_px = 571.25\n"
                          "cx_px = 3.5\n"
                          "cy_px = 2\n"
                          "k1 = -0.01\n"
                          "unit_mm = 0.5\n";

/* Writes a plane whose count at (column, row) is first + row_step * row + column. In a plane of
 * depth pixel (0, 0) is not measured. */
static void write_plane(const char *path, int first, int row_step, bool depth)
{
    uint16_t counts[STORED_HEIGHT][STORED_WIDTH];
    struct iso_image image = {STORED_WIDTH, STORED_HEIGHT, ISO_PIXEL_GREY16, counts, 0};
    for (int row = 0; row < STORED_HEIGHT; row++) {
        for (int column = 0; column < STORED_WIDTH; column++) {
            counts[row][column] = (uint16_t)(first + row_step * row + column);
        }
    }
    counts[0][0] = depth ? 0 : counts[0][0];
    assert_int_equal(iso_png_write(path, &image, 6, NULL), 0);
}

/* Writes the planes of one kind, depth or ir, and the list of them. */
static void write_planes(const char *directory, const char *kind, int n_frames)
{
    const bool depth = kind[0] == 'd';
    char list[4096] = "# timestamp_s filename\n", name[32];
    size_t used = strlen(list);
    scratch_mkdir(scratch_path(directory, kind));
    for (int f = 0; f < n_frames; f++) {
        (void)snprintf(name, sizeof name, "%s/%06d.png", kind, f);
        write_plane(scratch_path(directory, name), depth ? 1000 + 100 * f : 3000 + 500 * f,
                    depth ? 10 : 70, depth);
        used += (size_t)snprintf(list + used, sizeof list - used, "%.3f %s\n", 10.0 + f / 8.0,
                                 name);
    }
    (void)snprintf(name, sizeof name, "%s.txt", kind);
    scratch_write_text(scratch_path(directory, name), list);
}

void stored_frames_write(const char *directory, int n_frames)
{
    scratch_mkdir(directory);
    scratch_write_text(scratch_path(directory, "recording.ini"), stored_ini);
    write_planes(directory, "depth", n_frames);
}

void stored_frames_write_plain(const char *directory, int n_frames, double unit_mm, bool with_ir)
{
    char ini[512];
    (void)snprintf(ini, sizeof ini,
                   "[recording]\nformat = 1\nsensor = astra\n[depth]\nprojection = pinhole\n"
                   "width_px = %d\nheight_px = %d\nfx_px = 570.5\nfy_px = 571.25\n"
                   "cx_px = %.1f\ncy_px = %.1f\nunit_mm = %g\n",
                   STORED_WIDTH, STORED_HEIGHT, (STORED_WIDTH - 1) / 2.0, (STORED_HEIGHT - 1) / 2.0,
                   unit_mm);
    scratch_mkdir(directory);
    scratch_write_text(scratch_path(directory, "recording.ini"), ini);
    write_planes(directory, "depth", n_frames);
    if (with_ir) {
        write_planes(directory, "ir", n_frames);
    }
}

void stored_plane_write(const char *path, int width, int height, int bits, int channels,
                        unsigned value)
{
    size_t samples = (size_t)width * (size_t)height * (size_t)channels;
    uint16_t *words = calloc(samples, sizeof *words);
    struct iso_image image = {.width_px = width, .height_px = height, .samples = words};
    assert_non_null(words);
    for (size_t i = 0; i < samples; i++) {
        if (bits == 16) {
            words[i] = (uint16_t)value;
        } else {
            ((uint8_t *)words)[i] = (uint8_t)value;
        }
    }
    if (bits == 16) {
        image.pixel = channels == 3 ? ISO_PIXEL_RGB16 : ISO_PIXEL_GREY16;
    } else {
        image.pixel = channels == 3 ? ISO_PIXEL_RGB8 : ISO_PIXEL_GREY8;
    }
    assert_int_equal(iso_png_write(path, &image, 6, NULL), 0);
    free(words);
}
