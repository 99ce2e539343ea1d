/* PNG files: the reader returns exactly the samples that were written, and refuses every invalid
 * file. */
#include <errno.h>
#include <fcntl.h>
#include <png.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/file/png.h"
#include "tests/support/scratch.h"

enum { WIDTH = 11, HEIGHT = 6 };

static const enum iso_pixel kinds[] = {ISO_PIXEL_GREY8, ISO_PIXEL_GREY16, ISO_PIXEL_RGB8,
                                       ISO_PIXEL_RGB16};

/* Fills the samples with pseudo-random bytes, so that the test notices swapped samples and swapped
 * bytes. */
static void fill_image(uint8_t *bytes, size_t size)
{
    uint32_t x = 12345;
    for (size_t i = 0; i < size; i++) {
        x = x * 1664525u + 1013904223u;
        bytes[i] = (uint8_t)(x >> 24);
    }
}

static void write_sample(const char *path, enum iso_pixel kind, uint8_t *samples)
{
    struct iso_image image = {WIDTH, HEIGHT, kind, samples, 0};
    fill_image(samples, iso_image_row_bytes(&image) * HEIGHT);
    assert_int_equal(iso_png_write(path, &image, 9, NULL), 0);
}

static void reads_back_every_kind(void **state)
{
    uint8_t samples[WIDTH * HEIGHT * 6];
    struct iso_image image = {0};
    const char *path = scratch_path(*state, "a.png");
    for (size_t i = 0; i < 4; i++) {
        write_sample(path, kinds[i], samples);
        assert_int_equal(iso_png_read(path, NULL, &image, NULL), 0);
        assert_int_equal(image.width_px, WIDTH);
        assert_int_equal(image.height_px, HEIGHT);
        assert_int_equal(image.pixel, kinds[i]);
        assert_memory_equal(image.samples, samples, iso_image_row_bytes(&image) * HEIGHT);
    }
    iso_image_done(&image);
    assert_null(image.samples);
}

static void stores_sixteen_bits_big_endian(void **state)
{
    uint16_t sample = 0x1234;
    struct iso_image image = {1, 1, ISO_PIXEL_GREY16, &sample, 0};
    const char *path = scratch_path(*state, "a.png");
    png_image other = {.version = PNG_IMAGE_VERSION};
    assert_int_equal(iso_png_write(path, &image, 0, NULL), 0);
    size_t size;
    uint8_t *bytes = scratch_read(path, &size);
    const uint8_t stored[] = {0x00, 0x12, 0x34}; /* filter "none", then the sample */
    assert_non_null(memmem(bytes, size, stored, sizeof stored));
    assert_true(png_image_begin_read_from_memory(&other, bytes, size));
    assert_int_equal(other.width, 1);
    png_image_free(&other);
    free(bytes);
}

static void reuses_its_memory(void **state)
{
    uint8_t samples[WIDTH * HEIGHT * 6];
    struct iso_image image = {0};
    const char *path = scratch_path(*state, "a.png");
    write_sample(path, ISO_PIXEL_RGB16, samples);
    assert_int_equal(iso_png_read(path, NULL, &image, NULL), 0);
    const void *first = image.samples;
    write_sample(path, ISO_PIXEL_GREY8, samples);
    assert_int_equal(iso_png_read(path, NULL, &image, NULL), 0);
    assert_ptr_equal(image.samples, first);
    iso_image_done(&image);
}

static void refuses_every_truncation(void **state)
{
    uint8_t samples[WIDTH * HEIGHT * 6];
    struct iso_image image = {0};
    struct iso_fault fault;
    const char *path = scratch_path(*state, "a.png");
    size_t size;
    write_sample(path, ISO_PIXEL_GREY16, samples);
    uint8_t *bytes = scratch_read(path, &size);
    for (size_t length = 0; length < size; length++) {
        /* A copy of exactly this length, so that the sanitizer finds a read beyond it. */
        uint8_t *cut = malloc(length + 1);
        assert_non_null(cut);
        memcpy(cut, bytes, length);
        assert_int_equal(iso_png_read_memory("cut.png", cut, length, NULL, &image, &fault),
                         -EBADMSG);
        assert_int_equal(strncmp(fault.text, "cut.png: ", 9), 0);
        assert_null(strchr(fault.text, '\n'));
        assert_int_equal(image.width_px, 0);
        free(cut);
    }
    free(bytes);
    iso_image_done(&image);
}

static void refuses_every_changed_byte(void **state)
{
    uint8_t samples[WIDTH * HEIGHT * 6];
    struct iso_image image = {0};
    const char *path = scratch_path(*state, "a.png");
    size_t size;
    write_sample(path, ISO_PIXEL_GREY16, samples);
    uint8_t *bytes = scratch_read(path, &size);
    for (size_t i = 0; i < size; i++) {
        bytes[i] ^= 0x41;
        assert_int_not_equal(iso_png_read_memory("x.png", bytes, size, NULL, &image, NULL), 0);
        bytes[i] ^= 0x41;
    }
    assert_int_equal(iso_png_read_memory("x.png", bytes, size, NULL, &image, NULL), 0);
    free(bytes);
    iso_image_done(&image);
}

static void refuses_bytes_after_the_end(void **state)
{
    uint8_t samples[WIDTH * HEIGHT * 6];
    struct iso_image image = {0};
    struct iso_fault fault;
    const char *path = scratch_path(*state, "a.png");
    size_t size;
    write_sample(path, ISO_PIXEL_GREY8, samples);
    uint8_t *bytes = scratch_read(path, &size);
    bytes[size] = 0; /* scratch_read leaves room for one byte */
    assert_int_equal(iso_png_read_memory("a.png", bytes, size + 1, NULL, &image, &fault), -EBADMSG);
    assert_string_equal(fault.text, "a.png: bytes after the end of the picture");
    free(bytes);
    iso_image_done(&image);
}

static void refuses_what_was_not_expected(void **state)
{
    uint8_t samples[WIDTH * HEIGHT * 6];
    struct iso_image image = {0};
    struct iso_fault fault;
    const char *path = scratch_path(*state, "a.png");
    struct iso_png_expectation size = {.width_px = HEIGHT, .height_px = WIDTH};
    struct iso_png_expectation kind = {.pixels = ISO_PIXEL_GREY16 | ISO_PIXEL_RGB16};
    struct iso_png_expectation right = {ISO_PIXEL_GREY8 | ISO_PIXEL_GREY16, WIDTH, HEIGHT};
    write_sample(path, ISO_PIXEL_GREY8, samples);
    assert_int_equal(iso_png_read(path, &size, &image, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "a.png: 11x6 pixels instead of 6x11"));
    assert_int_equal(iso_png_read(path, &kind, &image, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "a.png: 8-bit grey is not the expected kind of picture"));
    assert_null(image.samples);
    assert_int_equal(iso_png_read(path, &right, &image, &fault), 0);
    iso_image_done(&image);
}

/* Writes with libpng the formats that our writer does not write. Returns the bytes. */
static uint8_t *write_other(const char *path, int bits, int colour_type, int interlace,
                            const uint8_t *samples, size_t row_bytes, size_t *size)
{
    FILE *file = fopen(path, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_color palette[2] = {{0, 0, 0}, {255, 255, 255}};
    png_bytep rows[HEIGHT];
    assert_non_null(file);
    for (int y = 0; y < HEIGHT; y++) {
        rows[y] = (png_bytep)(uintptr_t)(samples + (size_t)y * row_bytes);
    }
    png_init_io(png, file);
    png_set_IHDR(png, info, WIDTH, HEIGHT, bits, colour_type, interlace, 0, 0);
    if (colour_type == PNG_COLOR_TYPE_PALETTE) {
        png_set_PLTE(png, info, palette, 2);
    }
    png_write_info(png, info);
    png_write_image(png, rows);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    assert_int_equal(fclose(file), 0);
    return scratch_read(path, size);
}

static void refuses_other_kinds(void **state)
{
    static const struct {
        int bits, colour_type;
    } others[] = {{1, PNG_COLOR_TYPE_GRAY},    {4, PNG_COLOR_TYPE_GRAY},
                  {1, PNG_COLOR_TYPE_PALETTE}, {8, PNG_COLOR_TYPE_GRAY_ALPHA},
                  {8, PNG_COLOR_TYPE_RGBA},    {16, PNG_COLOR_TYPE_RGBA}};
    uint8_t samples[HEIGHT * WIDTH * 8] = {0};
    struct iso_image image = {0};
    struct iso_fault fault;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        size_t size;
        uint8_t *bytes = write_other(scratch_path(*state, "a.png"), others[i].bits,
                                     others[i].colour_type, 0, samples, (size_t)WIDTH * 8, &size);
        assert_int_equal(iso_png_read_memory("a.png", bytes, size, NULL, &image, &fault), -EINVAL);
        assert_non_null(strstr(fault.text, "is not supported"));
        free(bytes);
    }
}

static void reads_interlaced_pictures(void **state)
{
    uint8_t samples[HEIGHT * WIDTH];
    struct iso_image image = {0};
    size_t size;
    fill_image(samples, sizeof samples);
    uint8_t *bytes = write_other(scratch_path(*state, "a.png"), 8, PNG_COLOR_TYPE_GRAY,
                                 PNG_INTERLACE_ADAM7, samples, WIDTH, &size);
    assert_int_equal(iso_png_read_memory("a.png", bytes, size, NULL, &image, NULL), 0);
    assert_memory_equal(image.samples, samples, sizeof samples);
    free(bytes);
    iso_image_done(&image);
}

static void refuses_a_giant_without_taking_memory(void **state)
{
    /* A header of 8193 x 1 pixels, 8-bit grey, with its correct checksum. */
    static const uint8_t giant[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0,    0,    0,
                                    13,   'I', 'H', 'D', 'R',  0,    0,    0x20, 1,    0,    0,
                                    0,    1,   8,   0,   0,    0,    0,    0xbc, 0xe2, 0x14, 0x82};
    struct iso_image image = {0};
    struct iso_fault fault;
    (void)state;
    assert_int_equal(iso_png_read_memory("g.png", giant, sizeof giant, NULL, &image, &fault),
                     -EBADMSG);
    assert_non_null(strstr(fault.text, "g.png: Invalid IHDR"));
    assert_int_equal(image.capacity, 0);
}

static void names_files_that_cannot_be_read(void **state)
{
    struct iso_image image = {0};
    struct iso_fault fault;
    assert_int_equal(iso_png_read(scratch_path(*state, "none.png"), NULL, &image, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "none.png: No such file"));
    assert_int_equal(iso_png_read(*state, NULL, &image, &fault), -EISDIR);
    assert_non_null(strstr(fault.text, "is a directory, not a file"));
}

static void prints_nothing(void **state)
{
    const char *path = scratch_path(*state, "stderr");
    struct iso_image image = {0};
    static const uint8_t junk[] = "\x89PNG\r\n\x1a\n\0\0\0\1junkjunkjunk";
    size_t size;
    int file = open(path, O_CREAT | O_WRONLY, 0600), kept = dup(STDERR_FILENO);
    assert_true(file >= 0 && kept >= 0);
    assert_true(dup2(file, STDERR_FILENO) >= 0);
    int error = iso_png_read_memory("j.png", junk, sizeof junk, NULL, &image, NULL);
    assert_true(dup2(kept, STDERR_FILENO) >= 0);
    (void)close(kept);
    (void)close(file);
    assert_int_equal(error, -EBADMSG);
    free(scratch_read(path, &size));
    assert_int_equal(size, 0);
}

static void refuses_to_write_the_impossible(void **state)
{
    uint8_t sample = 0;
    struct iso_fault fault;
    const char *path = scratch_path(*state, "a.png");
    const struct iso_image bad[] = {
        {0, 1, ISO_PIXEL_GREY8, &sample, 0},
        {1, 8193, ISO_PIXEL_GREY8, &sample, 0},
        {1, 1, (enum iso_pixel)3, &sample, 0},
        {1, 1, ISO_PIXEL_GREY8, NULL, 0},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(iso_png_write(path, &bad[i], 6, &fault), -EINVAL);
        assert_non_null(strstr(fault.text, "a.png: not an image"));
    }
    struct iso_image good = {1, 1, ISO_PIXEL_GREY8, &sample, 0};
    assert_int_equal(iso_png_write(path, &good, 10, NULL), -EINVAL);
    assert_false(scratch_exists(path));
    assert_int_equal(iso_png_write(scratch_path(*state, "no/a.png"), &good, 6, NULL), -ENOENT);
}

static void a_full_disk_leaves_no_half_file(void **state)
{
    static uint8_t samples[200 * 100];
    struct iso_image image = {200, 100, ISO_PIXEL_GREY8, samples, 0};
    struct iso_fault fault;
    struct rlimit unlimited, limit;
    const char *path = scratch_path(*state, "a.png");
    fill_image(samples, sizeof samples);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    limit = unlimited;
    limit.rlim_cur = 9000;
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    int error = iso_png_write(path, &image, 0, &fault);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    assert_int_equal(error, -EFBIG);
    assert_non_null(strstr(fault.text, "a.png: File too large"));
    assert_false(scratch_exists(path));
}

static void a_device_survives_a_failed_write(void **state)
{
    static uint8_t samples[200 * 100];
    struct iso_image image = {200, 100, ISO_PIXEL_GREY8, samples, 0};
    struct iso_fault fault;
    const char *link = scratch_path(*state, "full.png");
    if (access("/dev/full", W_OK) != 0) {
        skip();
    }
    assert_int_equal(symlink("/dev/full", link), 0);
    assert_int_equal(iso_png_write(link, &image, 0, &fault), -ENOSPC);
    assert_non_null(strstr(fault.text, "full.png: No space left on device"));
    assert_true(scratch_exists(link));
}

#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(reads_back_every_kind),
        IN_SCRATCH(stores_sixteen_bits_big_endian),
        IN_SCRATCH(reuses_its_memory),
        IN_SCRATCH(refuses_every_truncation),
        IN_SCRATCH(refuses_every_changed_byte),
        IN_SCRATCH(refuses_bytes_after_the_end),
        IN_SCRATCH(refuses_what_was_not_expected),
        IN_SCRATCH(refuses_other_kinds),
        IN_SCRATCH(reads_interlaced_pictures),
        cmocka_unit_test(refuses_a_giant_without_taking_memory),
        IN_SCRATCH(names_files_that_cannot_be_read),
        IN_SCRATCH(prints_nothing),
        IN_SCRATCH(refuses_to_write_the_impossible),
        IN_SCRATCH(a_full_disk_leaves_no_half_file),
        IN_SCRATCH(a_device_survives_a_failed_write),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
