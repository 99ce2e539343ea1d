#include "firmware/recognise/relief_picture.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "core/frame/shrink.h"

enum { DARKEST = 24, BRIGHTEST = 255, PNG_LEVEL = 6 };

/* A neighbour whose depth differs by more than this belongs to another surface. */
static const double jump_mm = 30.0;

/* Nearer depths are drawn with full brightness, farther ones with the least. */
static const double near_mm = 400.0, far_mm = 2500.0;

/* ---- light ---- */

static bool is_neighbour(const struct iso_frame *frame, int column, int row, double depth_mm,
                         double *out_mm)
{
    if (column < 0 || row < 0 || column >= frame->width_px || row >= frame->height_px) {
        return false;
    }
    const double there_mm = (double)iso_frame_depth_at(frame, column, row);
    if (there_mm <= 0.0 || fabs(there_mm - depth_mm) > jump_mm) {
        return false;
    }
    *out_mm = there_mm;
    return true;
}

/* The slope of the depth along a row (dx 1) or a column (dy 1). It is computed from both
 * neighbours, or from one if the other is missing; it is 0 without neighbours. */
static double slope(const struct iso_frame *frame, int column, int row, int dx, int dy)
{
    const double depth_mm = (double)iso_frame_depth_at(frame, column, row);
    const double pixel_mm = iso_camera_pixel_mm(&frame->camera, depth_mm);
    double before_mm = depth_mm, after_mm = depth_mm;
    int steps = is_neighbour(frame, column - dx, row - dy, depth_mm, &before_mm);
    steps += is_neighbour(frame, column + dx, row + dy, depth_mm, &after_mm);
    return steps > 0 ? (after_mm - before_mm) / (steps * pixel_mm) : 0.0;
}

/* Lambert's law for the normal (x, y, -1) and the light from (-1, -1, -2) / sqrt 6, with some
 * ambient light; the brightness falls with distance. */
static uint8_t brightness(const struct iso_frame *frame, int column, int row)
{
    const double depth_mm = (double)iso_frame_depth_at(frame, column, row);
    const double x = slope(frame, column, row, 1, 0), y = slope(frame, column, row, 0, 1);
    const double lambert = (2.0 - x - y) / sqrt(6.0 * (1.0 + x * x + y * y));
    const double nearness = (far_mm - fmin(fmax(depth_mm, near_mm), far_mm)) / (far_mm - near_mm);
    const double lit = (0.15 + 0.85 * fmax(lambert, 0.0)) * (0.35 + 0.65 * nearness);
    return (uint8_t)(DARKEST + lrint((BRIGHTEST - DARKEST) * fmin(lit, 1.0)));
}

static void shade(const struct iso_frame *frame, uint8_t *pixels)
{
    for (int row = 0; row < frame->height_px; row++) {
        for (int column = 0; column < frame->width_px; column++) {
            const bool measured = iso_frame_depth_at(frame, column, row) > 0.0f;
            *pixels++ = measured ? brightness(frame, column, row) : 0;
        }
    }
}

/* ---- the picture ---- */

/* The smallest whole factor that makes the frame fit. */
static int factor_of(const struct iso_frame *frame)
{
    const int across = (frame->width_px + ISO_RELIEF_WIDTH_PX - 1) / ISO_RELIEF_WIDTH_PX;
    const int down = (frame->height_px + ISO_RELIEF_HEIGHT_PX - 1) / ISO_RELIEF_HEIGHT_PX;
    return across > down ? across : down;
}

static int draw(const struct iso_frame *frame, struct iso_frame *small, struct iso_image *out)
{
    const struct iso_window whole = {0, 0, frame->width_px, frame->height_px};
    const size_t size = (size_t)small->width_px * (size_t)small->height_px;
    const int error = iso_frame_shrink(frame, whole, factor_of(frame), size, small);
    if (error) {
        return error;
    }
    uint8_t *pixels = malloc(size);
    if (!pixels) {
        return -ENOMEM;
    }
    shade(small, pixels);
    *out = (struct iso_image){.width_px = small->width_px,
                              .height_px = small->height_px,
                              .pixel = ISO_PIXEL_GREY8,
                              .samples = pixels,
                              .capacity = size};
    return 0;
}

int iso_relief_picture(const struct iso_frame *frame, struct iso_image *out,
                       struct iso_fault *fault)
{
    const int factor = factor_of(frame);
    const int width_px = frame->width_px / factor, height_px = frame->height_px / factor;
    struct iso_frame *small = NULL;
    int error = iso_frame_new(&frame->camera, width_px, height_px, false, &small);
    if (!error) {
        error = draw(frame, small, out);
        explicit_bzero(small->depth_mm,
                       (size_t)width_px * (size_t)height_px * sizeof *small->depth_mm);
    }
    iso_frame_free(small);
    return error ? iso_fault_set(fault, error, "the frame cannot be drawn: %s", strerror(-error))
                 : 0;
}

/* ---- the file ---- */

static int write_sealed(int fd, const struct iso_image *image, struct iso_fault *fault)
{
    const int error = iso_png_write_descriptor(fd, "picture", image, PNG_LEVEL, fault);
    if (error) {
        return error;
    }
    if (lseek(fd, 0, SEEK_SET) < 0 ||
        fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL) < 0) {
        return iso_fault_set(fault, -errno, "the picture cannot be sealed: %m");
    }
    return 0;
}

int iso_relief_picture_file(const struct iso_frame *frame, struct iso_fault *fault)
{
    struct iso_image image = {.width_px = 0};
    int error = iso_relief_picture(frame, &image, fault);
    if (error) {
        return error;
    }
    const int fd = memfd_create("isotherm-picture", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    error = fd < 0 ? iso_fault_set(fault, -errno, "there is no memory file: %m")
                   : write_sealed(fd, &image, fault);
    explicit_bzero(image.samples, image.capacity);
    iso_image_done(&image);
    if (error && fd >= 0) {
        (void)close(fd);
    }
    return error ? error : fd;
}
