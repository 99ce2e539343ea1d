/* Pictures in a terminal, compared byte by byte. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <png.h>
#include <pty.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "enroll/cli/picture/terminal_picture.h"

/* Red, green, blue; white, black, grey. */
static const uint8_t six[] = {255, 0,   0,   0, 255, 0, 0,   0,   255,
                              255, 255, 255, 0, 0,   0, 128, 128, 128};

static char *half_blocks(const struct cli_pixels *pixels, int columns, int rows)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    assert_int_equal(cli_half_blocks_print(pixels, columns, rows, out), 0);
    assert_int_equal(fclose(out), 0);
    return text;
}

static void a_png_becomes_half_blocks(void **state)
{
    png_image image = {
        .version = PNG_IMAGE_VERSION, .width = 3, .height = 2, .format = PNG_FORMAT_RGB};
    uint8_t png[1024];
    png_alloc_size_t size = sizeof png;
    struct cli_pixels pixels;
    struct cli_fault fault = {0};

    (void)state;
    assert_int_not_equal(png_image_write_to_memory(&image, png, &size, 0, six, 0, NULL), 0);
    assert_int_equal(cli_pixels_decode(png, size, &pixels, &fault), CLI_EXIT_OK);
    assert_int_equal(pixels.width_px, 3);
    assert_int_equal(pixels.height_px, 2);
    assert_memory_equal(pixels.rgb, six, sizeof six);
    char *text = half_blocks(&pixels, 80, 30);
    assert_string_equal(text, "\033[38;2;255;0;0m\033[48;2;255;255;255m\u2580"
                              "\033[38;2;0;255;0m\033[48;2;0;0;0m\u2580"
                              "\033[38;2;0;0;255m\033[48;2;128;128;128m\u2580\033[0m\n");
    free(text);
    assert_int_equal(cli_pixels_decode(png, size / 2, &pixels, &fault), CLI_EXIT_FAULT);
    assert_string_equal(fault.code, "no-picture");
    cli_pixels_done(&pixels);
}

static size_t count_of(const char *text, const char *part)
{
    size_t n = 0;

    for (; (text = strstr(text, part)); text += strlen(part)) {
        n++;
    }
    return n;
}

/* 320 x 240 pixels in 80 columns take 30 lines; in 10 lines they take 26 columns. */
static void a_large_picture_is_made_to_fit(void **state)
{
    struct cli_pixels pixels = {320, 240, calloc(3, (size_t)320 * 240)};

    (void)state;
    assert_non_null(pixels.rgb);
    memset(pixels.rgb, 200, (size_t)3 * 320 * 120); /* the upper half is light */
    char *text = half_blocks(&pixels, 80, 30);
    assert_int_equal(count_of(text, "\n"), 30);
    assert_int_equal(count_of(text, "\u2580"), 80 * 30);
    assert_int_equal(count_of(text, "38;2;200;200;200m"), 80 * 15);
    free(text);
    text = half_blocks(&pixels, 80, 10);
    assert_int_equal(count_of(text, "\n"), 10);
    assert_int_equal(count_of(text, "\u2580"), 26 * 10);
    free(text);
    cli_pixels_done(&pixels);
}

static void sixels_are_bands_of_six_by_shade(void **state)
{
    uint8_t rgb[5 * 7 * 3] = {0}; /* 5 wide, 7 high, black with one white pixel */
    const struct cli_pixels pixels = {5, 7, rgb};
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    (void)state;
    memset(rgb + 3 * (5 * 1 + 4), 255, 3);
    cli_sixel_print(&pixels, out);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(strncmp(text, "\033Pq\"1;1;5;7#0;2;0;0;0", 21), 0);
    const char *data = strstr(text, "#63;2;100;100;100");
    assert_non_null(data);
    assert_string_equal(data + 17, "#0!4~|$#63!4?A$-#0!5@$-\033\\\n");
    free(text);
}

/* Runs cli_terminal_has_sixels() on a terminal that answers the question for its attributes with
 * this text (NULL: it does not answer). */
static bool ask_terminal(const char *answer)
{
    int master, slave, status;
    char question[8] = "";

    assert_int_equal(openpty(&master, &slave, NULL, NULL, NULL), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        _exit(cli_terminal_has_sixels(slave, slave) ? 10 : 20);
    }
    assert_int_equal(read(master, question, 3), 3);
    assert_string_equal(question, "\033[c");
    if (answer) {
        assert_int_equal(write(master, answer, strlen(answer)), strlen(answer));
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    close(slave);
    close(master);
    return WEXITSTATUS(status) == 10;
}

static void a_terminal_says_whether_it_has_sixels(void **state)
{
    int ends[2];

    (void)state;
    assert_true(ask_terminal("\033[?62;4;22c"));
    assert_true(ask_terminal("\033[?65;1;9;4c"));
    assert_false(ask_terminal("\033[?62;22c"));
    assert_false(ask_terminal("\033[?4;14;44c"));
    assert_false(ask_terminal(NULL));
    assert_int_equal(pipe(ends), 0);
    assert_false(cli_terminal_has_sixels(ends[0], ends[1]));
    close(ends[0]);
    close(ends[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_png_becomes_half_blocks),
        cmocka_unit_test(a_large_picture_is_made_to_fit),
        cmocka_unit_test(sixels_are_bands_of_six_by_shade),
        cmocka_unit_test(a_terminal_says_whether_it_has_sixels),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
