#include "drivers/file/png.h"

#include <errno.h>
#include <fcntl.h>
#include <png.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/file.h"

/* One file while libpng works on it. After an error libpng returns by longjmp, which leaves local
 * variables undefined. Everything that is needed then is in this struct, and a function that calls
 * setjmp only returns false after such a jump. */
struct codec {
    png_structp png;
    png_infop info;
    FILE *file;
    struct iso_image image;
    char message[128]; /* why libpng stopped */
    int error;         /* negative errno of the file; 0 if its contents are wrong */
};

static const struct format {
    enum iso_pixel pixel;
    png_byte colour_type;
    int bits, channels;
    const char *name;
} formats[] = {
    {ISO_PIXEL_GREY8, PNG_COLOR_TYPE_GRAY, 8, 1, "8-bit grey"},
    {ISO_PIXEL_GREY16, PNG_COLOR_TYPE_GRAY, 16, 1, "16-bit grey"},
    {ISO_PIXEL_RGB8, PNG_COLOR_TYPE_RGB, 8, 3, "8-bit RGB"},
    {ISO_PIXEL_RGB16, PNG_COLOR_TYPE_RGB, 16, 3, "16-bit RGB"},
};

enum { FORMATS = sizeof formats / sizeof *formats };

static const struct format *format_of(enum iso_pixel pixel)
{
    for (int i = 0; i < FORMATS; i++) {
        if (formats[i].pixel == pixel) {
            return &formats[i];
        }
    }
    return NULL;
}

size_t iso_image_row_bytes(const struct iso_image *image)
{
    const struct format *format = format_of(image->pixel);
    return format ? (size_t)image->width_px * (size_t)(format->bits / 8 * format->channels) : 0;
}

void iso_image_done(struct iso_image *image)
{
    free(image->samples);
    *image = (struct iso_image){0};
}

static _Noreturn void on_error(png_structp png, png_const_charp message)
{
    struct codec *codec = png_get_error_ptr(png);
    (void)snprintf(codec->message, sizeof codec->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png; /* warnings about pixels are errors already, see forbid_mending */
    (void)message;
}

static void on_read(png_structp png, png_bytep bytes, size_t size)
{
    struct codec *codec = png_get_io_ptr(png);
    errno = 0;
    if (fread(bytes, 1, size, codec->file) != size) {
        const int failed = errno ? -errno : -EIO;
        codec->error = ferror(codec->file) ? failed : 0;
        png_error(png, codec->error ? strerror(-codec->error) : "truncated");
    }
}

static void on_write(png_structp png, png_bytep bytes, size_t size)
{
    struct codec *codec = png_get_io_ptr(png);
    errno = 0;
    if (fwrite(bytes, 1, size, codec->file) != size) {
        codec->error = errno ? -errno : -EIO;
        png_error(png, strerror(-codec->error));
    }
}

static void on_flush(png_structp png)
{
    (void)png; /* closing the file flushes it, and its result is checked */
}

/* ---- reading ---------------------------------------------------------------- */

static void forbid_mending(png_structp png)
{
    png_set_benign_errors(png, 0);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_user_limits(png, ISO_PNG_SIDE_MAX, ISO_PNG_SIDE_MAX);
    png_set_chunk_malloc_max(png, 1 << 20);
    png_set_chunk_cache_max(png, 64);
}

static bool read_header(struct codec *codec)
{
    if (setjmp(png_jmpbuf(codec->png))) {
        return false;
    }
    forbid_mending(codec->png);
    png_set_read_fn(codec->png, codec, on_read);
    png_read_info(codec->png, codec->info);
    return true;
}

static bool read_rows(struct codec *codec)
{
    if (setjmp(png_jmpbuf(codec->png))) {
        return false;
    }
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    png_set_swap(codec->png);
#endif
    for (int pass = png_set_interlace_handling(codec->png); pass > 0; pass--) {
        png_bytep row = codec->image.samples;
        for (int y = 0; y < codec->image.height_px; y++) {
            png_read_row(codec->png, row, NULL);
            row += iso_image_row_bytes(&codec->image);
        }
    }
    png_read_end(codec->png, NULL);
    return true;
}

static int read_fault(const struct codec *codec, const char *name, struct iso_fault *fault)
{
    const int error = codec->error ? codec->error : -EBADMSG;
    return iso_fault_set(fault, error, "%s: %s", name, codec->message);
}

/* Checks that the header describes a picture of the expected kind. */
static int shape_of(const struct codec *codec, const char *name,
                    const struct iso_png_expectation *expected, struct iso_image *shape,
                    struct iso_fault *fault)
{
    const int width = (int)png_get_image_width(codec->png, codec->info);
    const int height = (int)png_get_image_height(codec->png, codec->info);
    const int bits = png_get_bit_depth(codec->png, codec->info);
    const int colour_type = png_get_color_type(codec->png, codec->info);
    const struct format *format = NULL;
    for (int i = 0; i < FORMATS; i++) {
        if (formats[i].bits == bits && formats[i].colour_type == colour_type) {
            format = &formats[i];
        }
    }
    if (!format) {
        return iso_fault_set(fault, -EINVAL, "%s: %d-bit PNG of colour type %d is not supported",
                             name, bits, colour_type);
    }
    if (expected && expected->pixels && !(expected->pixels & (unsigned)format->pixel)) {
        return iso_fault_set(fault, -EINVAL, "%s: %s is not the expected kind of picture", name,
                             format->name);
    }
    if (expected && ((expected->width_px && expected->width_px != width) ||
                     (expected->height_px && expected->height_px != height))) {
        return iso_fault_set(fault, -EINVAL, "%s: %dx%d pixels instead of %dx%d", name, width,
                             height, expected->width_px, expected->height_px);
    }
    *shape = (struct iso_image){.width_px = width, .height_px = height, .pixel = format->pixel};
    return 0;
}

static int make_room(const struct iso_image *shape, const char *name, struct iso_image *image,
                     struct iso_fault *fault)
{
    const size_t bytes = iso_image_row_bytes(shape) * (size_t)shape->height_px;
    if (bytes > image->capacity) {
        void *samples = realloc(image->samples, bytes);
        if (!samples) {
            return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
        }
        image->samples = samples;
        image->capacity = bytes;
    }
    return 0;
}

static int read_png(struct codec *codec, const char *name,
                    const struct iso_png_expectation *expected, struct iso_image *image,
                    struct iso_fault *fault)
{
    if (!read_header(codec)) {
        return read_fault(codec, name, fault);
    }
    int error = shape_of(codec, name, expected, &codec->image, fault);
    if (!error) {
        error = make_room(&codec->image, name, image, fault);
    }
    if (error) {
        return error;
    }
    codec->image.samples = image->samples;
    codec->image.capacity = image->capacity;
    if (!read_rows(codec)) {
        return read_fault(codec, name, fault);
    }
    if (fgetc(codec->file) != EOF) {
        return iso_fault_set(fault, -EBADMSG, "%s: bytes after the end of the picture", name);
    }
    *image = codec->image;
    return 0;
}

static int read_file(const char *name, FILE *file, const struct iso_png_expectation *expected,
                     struct iso_image *image, struct iso_fault *fault)
{
    struct codec codec = {.file = file};
    int error = -ENOMEM;
    codec.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &codec, on_error, on_warning);
    codec.info = codec.png ? png_create_info_struct(codec.png) : NULL;
    if (codec.info) {
        error = read_png(&codec, name, expected, image, fault);
    } else {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    png_destroy_read_struct(&codec.png, &codec.info, NULL);
    return error;
}

int iso_png_read(const char *path, const struct iso_png_expectation *expected,
                 struct iso_image *image, struct iso_fault *fault)
{
    FILE *file = NULL;
    int error = iso_file_stream(path, ISO_PNG_BYTES_MAX, &file, fault);
    if (error) {
        return error;
    }
    error = read_file(path, file, expected, image, fault);
    (void)fclose(file);
    return error;
}

int iso_png_read_memory(const char *name, const void *bytes, size_t size,
                        const struct iso_png_expectation *expected, struct iso_image *image,
                        struct iso_fault *fault)
{
    if (size == 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: truncated", name);
    }
    /* The file is opened for reading only, and fmemopen does not write into the bytes. */
    FILE *file = fmemopen((void *)(uintptr_t)bytes, size, "rb");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %m", name);
    }
    const int error = read_file(name, file, expected, image, fault);
    (void)fclose(file);
    return error;
}

/* ---- writing ---------------------------------------------------------------- */

static bool write_picture(struct codec *codec, const struct format *format, int level)
{
    if (setjmp(png_jmpbuf(codec->png))) {
        return false;
    }
    png_set_write_fn(codec->png, codec, on_write, on_flush);
    png_set_compression_level(codec->png, level);
    png_set_IHDR(codec->png, codec->info, (png_uint_32)codec->image.width_px,
                 (png_uint_32)codec->image.height_px, format->bits, format->colour_type,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(codec->png, codec->info);
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    png_set_swap(codec->png);
#endif
    png_const_bytep row = codec->image.samples;
    for (int y = 0; y < codec->image.height_px; y++) {
        png_write_row(codec->png, row);
        row += iso_image_row_bytes(&codec->image);
    }
    png_write_end(codec->png, codec->info);
    return true;
}

static int write_file(FILE *file, const struct iso_image *image, int level, const char *path,
                      struct iso_fault *fault)
{
    struct codec codec = {.file = file, .image = *image};
    int error = 0;
    codec.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &codec, on_error, on_warning);
    codec.info = codec.png ? png_create_info_struct(codec.png) : NULL;
    if (!codec.info) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    } else if (!write_picture(&codec, format_of(image->pixel), level)) {
        error = codec.error ? codec.error : -EINVAL;
        (void)iso_fault_set(fault, error, "%s: %s", path, codec.message);
    }
    png_destroy_write_struct(&codec.png, &codec.info);
    return error;
}

/* Removes only a regular file, not a device or a pipe. */
static void remove_partial_file(const char *path)
{
    struct stat status;
    if (lstat(path, &status) == 0 && S_ISREG(status.st_mode)) {
        (void)unlink(path);
    }
}

static bool can_be_written(const struct iso_image *image, int level)
{
    return format_of(image->pixel) && image->samples && image->width_px >= 1 &&
           image->height_px >= 1 && image->width_px <= ISO_PNG_SIDE_MAX &&
           image->height_px <= ISO_PNG_SIDE_MAX && level >= 0 && level <= 9;
}

/* Writes the image and closes the file. */
static int write_and_close(FILE *file, const struct iso_image *image, int level, const char *name,
                           struct iso_fault *fault)
{
    int error = write_file(file, image, level, name, fault);
    if (fclose(file) != 0 && !error) {
        error = iso_fault_set(fault, -errno, "%s: %m", name);
    }
    return error;
}

int iso_png_write_descriptor(int fd, const char *name, const struct iso_image *image, int level,
                             struct iso_fault *fault)
{
    if (!can_be_written(image, level)) {
        return iso_fault_set(fault, -EINVAL, "%s: not an image that can be written", name);
    }
    const int own = fcntl(fd, F_DUPFD_CLOEXEC, 0);
    FILE *file = own >= 0 ? fdopen(own, "wb") : NULL;
    if (!file) {
        const int error = -errno;
        if (own >= 0) {
            (void)close(own);
        }
        return iso_fault_set(fault, error, "%s: %s", name, strerror(-error));
    }
    return write_and_close(file, image, level, name, fault);
}

int iso_png_write(const char *path, const struct iso_image *image, int level,
                  struct iso_fault *fault)
{
    if (!can_be_written(image, level)) {
        return iso_fault_set(fault, -EINVAL, "%s: not an image that can be written", path);
    }
    FILE *file = fopen(path, "wbe");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    const int error = write_and_close(file, image, level, path, fault);
    if (error) {
        remove_partial_file(path);
    }
    return error;
}
