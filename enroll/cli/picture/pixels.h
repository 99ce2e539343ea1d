/* The pixels of a picture, decoded and scaled down. They can show the shape of a face, so they are
 * wiped before they are freed. */
#ifndef CLI_PICTURE_PIXELS_H
#define CLI_PICTURE_PIXELS_H

#include <stddef.h>
#include <stdint.h>

#include "enroll/cli/client/fault.h"

struct cli_pixels {
    int width_px, height_px;
    uint8_t *rgb; /* [height_px * width_px * 3] */
};

/* Decodes a PNG of at most 4096 x 4096 pixels. CLI_EXIT_FAULT "no-picture" if that fails. */
enum cli_exit cli_pixels_decode(const uint8_t *png, size_t size, struct cli_pixels *out,
                                struct cli_fault *fault) __attribute__((warn_unused_result));

/* Wipes and frees the pixels. An all-zero *picture is accepted. */
void cli_pixels_done(struct cli_pixels *picture);

/* Makes a copy of a picture in a new size, at least 1 x 1: each pixel is the mean of those that it
 * covers. cli_pixels_done() frees *out. -ENOMEM. */
int cli_pixels_scale(const struct cli_pixels *picture, int width_px, int height_px,
                     struct cli_pixels *out) __attribute__((warn_unused_result));

#endif
