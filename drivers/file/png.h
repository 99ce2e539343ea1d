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

/* The limits of the longer side of a picture and of the size of a file. The largest picture fits as
 * 16-bit RGB without compression. */
enum { ISO_PNG_SIDE_MAX = 8192, ISO_PNG_BYTES_MAX = 1 << 29 };

/* A picture: rows from the top without padding, samples uint8_t or uint16_t of the host's order. */
struct iso_image {
    int width_px, height_px;
    enum iso_pixel pixel;
    void *samples;
    size_t capacity; /* bytes that samples has room for: kept when the image is read into again */
};

/* Bytes of one row; 0 for an unknown kind of pixels. */
size_t iso_image_row_bytes(const struct iso_image *image);

/* Frees the samples; an all-zero image is fine, and is what remains. */
void iso_image_done(struct iso_image *image);

/* What a file must be; zeros accept anything. Checked before memory is taken for the picture. */
struct iso_png_expectation {
    unsigned pixels; /* set of enum iso_pixel */
    int width_px, height_px;
};

/* Reads a file into an image that was zeroed or read before; its memory is reused. After a failure
 * the samples are undefined, and of the rest of the image only the capacity may have changed.
 * -EBADMSG the file is not a sound PNG, or a side is longer than ISO_PNG_SIDE_MAX; -EINVAL its kind
 * is not supported, or it is not as expected (`expected` may be NULL); -ENOMEM, the errors of
 * iso_file_stream, or the errno of read. */
int iso_png_read(const char *path, const struct iso_png_expectation *expected,
                 struct iso_image *image, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same from memory; `name` stands for the file in faults. */
int iso_png_read_memory(const char *name, const void *bytes, size_t size,
                        const struct iso_png_expectation *expected, struct iso_image *image,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes a file; `level` is zlib's 0 (stored) .. 9 (smallest). A file that could not be written
 * whole is removed. -EINVAL for an impossible image or level, -ENOMEM, or the errno of writing. */
int iso_png_write(const char *path, const struct iso_image *image, int level,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same into an open file, at its present position. The descriptor stays open, and after a
 * failure the part that was written stays. `name` is the file's name in faults. */
int iso_png_write_descriptor(int fd, const char *name, const struct iso_image *image, int level,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
