/* PNG files, read strictly and written reproducibly: 8- and 16-bit grey and RGB.
 *
 * Everything that libpng would repair or ignore is refused: truncation, bad checksums, missing
 * pixels, bytes after the end; so are palettes, alpha and other bit depths. Nothing is printed;
 * every failure is one line "file: what is wrong" in *fault (which may be NULL). */
#ifndef ISO_DRIVERS_FILE_PNG_H
#define ISO_DRIVERS_FILE_PNG_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

/* Bits, so that they can be combined to a set. */
enum iso_pixel {
    ISO_PIXEL_GREY8 = 1,
    ISO_PIXEL_GREY16 = 2,
    ISO_PIXEL_RGB8 = 4,
    ISO_PIXEL_RGB16 = 8,
};

/* The longer side of a picture, and the bytes of a file: the largest picture, 16-bit RGB, stored
 * without compression, fits. */
enum { ISO_PNG_SIDE_MAX = 8192, ISO_PNG_BYTES_MAX = 1 << 29 };

/* A picture: rows from the top without padding, samples uint8_t or uint16_t of the host's order. */
struct iso_image {
    int width_px, height_px;
    enum iso_pixel pixel;
    void *samples;
    size_t capacity; /* bytes that samples has room for: kept when the image is read into again */
};

/* Bytes of one row. */
size_t iso_image_row_bytes(const struct iso_image *image);

/* Frees the samples; an all-zero image is fine, and is what remains. */
void iso_image_done(struct iso_image *image);

/* What a file must be; zeros accept anything. Checked before memory is taken for the picture. */
struct iso_png_expectation {
    unsigned pixels; /* set of enum iso_pixel */
    int width_px, height_px;
};

/* Reads a file into an image that was zeroed or read before; its memory is reused. On failure the
 * samples are undefined, the rest of the image untouched but for its capacity. -EBADMSG not a sound
 * PNG, -EINVAL one that is not as expected (`expected` may be NULL) or over ISO_PNG_SIDE_MAX,
 * -ENOMEM, the errors of iso_file_stream, or the errno of read. */
int iso_png_read(const char *path, const struct iso_png_expectation *expected,
                 struct iso_image *image, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same from memory; `name` stands for the file in faults. */
int iso_png_read_memory(const char *name, const void *bytes, size_t size,
                        const struct iso_png_expectation *expected, struct iso_image *image,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes a file; `level` is zlib's 0 (stored) .. 9 (smallest). A file that could not be written
 * whole is removed. -EINVAL for an impossible image, -ENOMEM, or the errno of writing. */
int iso_png_write(const char *path, const struct iso_image *image, int level,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same into an open file, at its present position. The descriptor stays open, and after a
 * failure the part that was written stays. `name` is the file's name in faults. */
int iso_png_write_descriptor(int fd, const char *name, const struct iso_image *image, int level,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
