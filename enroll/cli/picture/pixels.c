#include "enroll/cli/picture/pixels.h"

#include <errno.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_PX_MAX = 4096 };

static enum cli_exit no_picture(struct cli_fault *fault, const char *why)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "no-picture", "no picture: %s", why);
}

enum cli_exit cli_pixels_decode(const uint8_t *png, size_t size, struct cli_pixels *out,
                                struct cli_fault *fault)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    const png_color black = {0};
    struct cli_pixels picture = {0};
    enum cli_exit exit = CLI_EXIT_OK;

    if (!png_image_begin_read_from_memory(&image, png, size)) {
        return no_picture(fault, image.message);
    }
    image.format = PNG_FORMAT_RGB;
    if (image.width > SIDE_PX_MAX || image.height > SIDE_PX_MAX) {
        exit = no_picture(fault, "it is too large");
    } else {
        picture.width_px = (int)image.width;
        picture.height_px = (int)image.height;
        picture.rgb = malloc(PNG_IMAGE_SIZE(image));
        if (!picture.rgb || !png_image_finish_read(&image, &black, picture.rgb, 0, NULL)) {
            exit = no_picture(fault, picture.rgb ? image.message : strerror(ENOMEM));
        }
    }
    png_image_free(&image);
    if (exit) {
        free(picture.rgb);
        return exit;
    }
    *out = picture;
    return CLI_EXIT_OK;
}

void cli_pixels_done(struct cli_pixels *picture)
{
    if (picture->rgb) {
        explicit_bzero(picture->rgb, (size_t)picture->width_px * (size_t)picture->height_px * 3);
    }
    free(picture->rgb);
    *picture = (struct cli_pixels){0};
}

/* The mean of a channel over the pixels from (left, top) up to, but without, (right, bottom). */
static uint8_t mean(const struct cli_pixels *picture, int left, int top, int right, int bottom,
                    int channel)
{
    uint64_t sum = 0;

    for (int y = top; y < bottom; y++) {
        for (int x = left; x < right; x++) {
            sum += picture->rgb[((size_t)y * (size_t)picture->width_px + (size_t)x) * 3 +
                                (size_t)channel];
        }
    }
    return (uint8_t)(sum / ((uint64_t)(right - left) * (uint64_t)(bottom - top)));
}

int cli_pixels_scale(const struct cli_pixels *picture, int width_px, int height_px,
                     struct cli_pixels *out)
{
    struct cli_pixels scaled = {width_px, height_px,
                                malloc((size_t)width_px * (size_t)height_px * 3)};

    if (!scaled.rgb) {
        return -ENOMEM;
    }
    for (int y = 0; y < height_px; y++) {
        const int top = y * picture->height_px / height_px;
        const int below = (y + 1) * picture->height_px / height_px;
        for (int x = 0; x < width_px; x++) {
            const int left = x * picture->width_px / width_px;
            const int beyond = (x + 1) * picture->width_px / width_px;
            uint8_t *pixel = scaled.rgb + ((size_t)y * (size_t)width_px + (size_t)x) * 3;
            for (int c = 0; c < 3; c++) {
                pixel[c] = mean(picture, left, top, beyond > left ? beyond : left + 1,
                                below > top ? below : top + 1, c);
            }
        }
    }
    *out = scaled;
    return 0;
}
