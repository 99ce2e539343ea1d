#include "enroll/cli/picture/terminal_picture.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

enum {
    STANDARD_COLUMNS = 80,
    STANDARD_ROWS = 30,
    ANSWER_MS = 200,
    SIXEL_HEIGHT = 6,
    SHADES = 64,
};

/* ---- half blocks ---- */

static const uint8_t *pixel_of(const struct cli_pixels *picture, int x, int y)
{
    return picture->rgb + ((size_t)y * (size_t)picture->width_px + (size_t)x) * 3;
}

/* In an upper half block, the upper pixel has the foreground colour and the lower one the
 * background colour. */
static void print_cell(const uint8_t *upper, const uint8_t *lower, FILE *out)
{
    fprintf(out, "\033[38;2;%d;%d;%dm", upper[0], upper[1], upper[2]);
    if (lower) {
        fprintf(out, "\033[48;2;%d;%d;%dm", lower[0], lower[1], lower[2]);
    }
    fputs("\u2580", out);
}

int cli_half_blocks_print(const struct cli_pixels *picture, int columns, int rows, FILE *out)
{
    int width_px = picture->width_px, height_px = picture->height_px;
    struct cli_pixels small = {0};

    if (width_px > columns) {
        height_px = height_px * columns / width_px;
        width_px = columns;
    }
    if (height_px > 2 * rows) {
        width_px = width_px * 2 * rows / height_px;
        height_px = 2 * rows;
    }
    const int error = cli_pixels_scale(picture, width_px > 0 ? width_px : 1,
                                       height_px > 0 ? height_px : 1, &small);
    for (int y = 0; !error && y < small.height_px; y += 2) {
        for (int x = 0; x < small.width_px; x++) {
            print_cell(pixel_of(&small, x, y),
                       y + 1 < small.height_px ? pixel_of(&small, x, y + 1) : NULL, out);
        }
        fputs("\033[0m\n", out);
    }
    cli_pixels_done(&small);
    return error;
}

/* ---- sixels ---- */

/* The number of the shade, 0..SHADES - 1, for the luma of a pixel (Rec. 709). */
static int shade_of(const uint8_t *rgb)
{
    return (2126 * rgb[0] + 7152 * rgb[1] + 722 * rgb[2]) / 10000 * SHADES / 256;
}

/* Returns which of six pixels have this shade; the lowest bit is the uppermost pixel. */
static int bits_of(const struct cli_pixels *picture, int x, int top, int shade)
{
    int bits = 0;

    for (int i = 0; i < SIXEL_HEIGHT && top + i < picture->height_px; i++) {
        bits |= (shade_of(pixel_of(picture, x, top + i)) == shade) << i;
    }
    return bits;
}

static void print_run(int character, int length, FILE *out)
{
    if (length > 3) {
        fprintf(out, "!%d%c", length, character);
        return;
    }
    for (int i = 0; i < length; i++) {
        fputc(character, out);
    }
}

/* Writes a band six pixels high in one shade, as runs of the same character. */
static void print_shade(const struct cli_pixels *picture, int top, int shade, FILE *out)
{
    int character = 0, length = 0;

    fprintf(out, "#%d", shade);
    for (int x = 0; x < picture->width_px; x++) {
        const int next = '?' + bits_of(picture, x, top, shade);
        if (next != character) {
            print_run(character, length, out);
            length = 0;
        }
        character = next;
        length++;
    }
    print_run(character, length, out);
    fputc('$', out); /* go back to the left border */
}

static void find_shades(const struct cli_pixels *picture, int top, bool there[SHADES])
{
    memset(there, 0, SHADES * sizeof *there);
    for (int y = top; y < top + SIXEL_HEIGHT && y < picture->height_px; y++) {
        for (int x = 0; x < picture->width_px; x++) {
            there[shade_of(pixel_of(picture, x, y))] = true;
        }
    }
}

void cli_sixel_print(const struct cli_pixels *picture, FILE *out)
{
    bool there[SHADES];

    fprintf(out, "\033Pq\"1;1;%d;%d", picture->width_px, picture->height_px);
    for (int i = 0; i < SHADES; i++) {
        /* The red, green and blue of a shade are in percent. */
        const int percent = i * 100 / (SHADES - 1);
        fprintf(out, "#%d;2;%d;%d;%d", i, percent, percent, percent);
    }
    for (int top = 0; top < picture->height_px; top += SIXEL_HEIGHT) {
        find_shades(picture, top, there);
        for (int shade = 0; shade < SHADES; shade++) {
            if (there[shade]) {
                print_shade(picture, top, shade, out);
            }
        }
        fputc('-', out); /* go to the next band */
    }
    fputs("\033\\\n", out);
}

/* ---- the terminal ---- */

/* The terminal answers "ESC [ ? 6 4 ; 1 ; 4 ; ... c". A 4 after the first number means that it
 * shows sixels. */
static bool names_sixels(const char *answer)
{
    const char *at = strstr(answer, "\033[?");

    while (at && (at = strchr(at, ';'))) {
        at++;
        if (strspn(at, "0123456789") == 1 && *at == '4') {
            return true;
        }
    }
    return false;
}

static void read_answer(int in, char *answer, size_t size)
{
    size_t length = 0;

    answer[0] = '\0';
    while (length < size - 1 && !strchr(answer, 'c')) {
        struct pollfd waiting = {.fd = in, .events = POLLIN};
        if (poll(&waiting, 1, ANSWER_MS) <= 0 || read(in, answer + length, 1) != 1) {
            return;
        }
        answer[++length] = '\0';
    }
}

bool cli_terminal_has_sixels(int in, int out)
{
    static const char question[] = "\033[c";
    struct termios before, raw;
    char answer[64] = "";

    if (!isatty(in) || !isatty(out) || tcgetattr(in, &before) < 0) {
        return false;
    }
    raw = before;
    raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    if (tcsetattr(in, TCSAFLUSH, &raw) < 0) {
        return false;
    }
    if (write(out, question, sizeof question - 1) == (ssize_t)sizeof question - 1) {
        read_answer(in, answer, sizeof answer);
    }
    (void)tcsetattr(in, TCSAFLUSH, &before);
    return names_sixels(answer);
}

bool cli_terminal_show(const struct cli_pixels *picture, int in, FILE *out)
{
    const char *type = getenv("TERM"), *no_colour = getenv("NO_COLOR");
    struct winsize size = {0};
    const int fd = fileno(out);

    if (!isatty(in) || !isatty(fd) || !type || strcmp(type, "dumb") == 0 ||
        (no_colour && *no_colour)) {
        return false;
    }
    (void)fflush(out);
    if (cli_terminal_has_sixels(in, fd)) {
        cli_sixel_print(picture, out);
        return true;
    }
    (void)ioctl(fd, TIOCGWINSZ, &size);
    const int columns = size.ws_col > 0 && size.ws_col < STANDARD_COLUMNS ? size.ws_col
                                                                          : STANDARD_COLUMNS;
    const int rows = size.ws_row > 4 && size.ws_row - 2 < STANDARD_ROWS ? size.ws_row - 2
                                                                        : STANDARD_ROWS;
    return cli_half_blocks_print(picture, columns, rows, out) == 0;
}
