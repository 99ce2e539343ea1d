/* The window of the screen on a real X server without a monitor (Xvfb), whose picture is compared
 * with the PNG that the program writes. No daemon is there, so that the screen says that it is out
 * of service. It needs Xvfb and SDL. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cairo.h>
#include <cmocka.h>
#include <signal.h>

#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

enum { WIDTH = 640, HEIGHT = 480, WAIT_MS = 20000, LOOK_MS = 100, SKIPPED = 77 };

static const char program[] = ISOTHERM_BINARY_DIR "/enroll/screen/isotherm-screen";
static const char nowhere[] = "unix:path=/nonexistent/bus";
static struct run server;

static int setup(void **state)
{
    char screen[32];
    char display[32];
    if (scratch_setup(state)) {
        return -1;
    }
    (void)snprintf(screen, sizeof screen, "%dx%dx24", WIDTH, HEIGHT);
    const char *const argv[] = {"/usr/bin/Xvfb", "-displayfd", "1",    "-screen", "0",
                                screen,          "-fbdir",     *state, "-ac",     NULL};
    run_start(&server, argv);
    run_until(&server, "\n");
    (void)snprintf(display, sizeof display, ":%d", atoi(server.out));
    return setenv("DISPLAY", display, 1) | setenv("SDL_VIDEODRIVER", "x11", 1);
}

static int teardown(void **state)
{
    (void)kill(server.pid, SIGTERM);
    run_finish(&server);
    run_free(&server);
    return scratch_teardown(state);
}

static uint32_t big_endian(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

/* The picture of the X server's screen, which its file has in the format of xwd (XWDFile.h): words
 * 0, 4, 5, 12, 19 of the header are its size, width, height, bytes of a line and colours of 12
 * bytes. */
static void read_screen(const char *directory, uint32_t pixels[HEIGHT][WIDTH])
{
    size_t size = 0;
    uint8_t *bytes = scratch_read(scratch_path(directory, "Xvfb_screen0"), &size);
    assert_true(size > 100);
    assert_int_equal(big_endian(bytes + 16), WIDTH);
    assert_int_equal(big_endian(bytes + 20), HEIGHT);
    const size_t line = big_endian(bytes + 48);
    const size_t begin = big_endian(bytes) + (size_t)12 * big_endian(bytes + 76);
    assert_true(size >= begin + line * HEIGHT);
    for (int y = 0; y < HEIGHT; y++) {
        memcpy(pixels[y], bytes + begin + (size_t)y * line, sizeof pixels[y]);
        for (int x = 0; x < WIDTH; x++) {
            pixels[y][x] &= 0xffffff;
        }
    }
    free(bytes);
}

static void read_png(const char *path, uint32_t pixels[HEIGHT][WIDTH])
{
    cairo_surface_t *surface = cairo_image_surface_create_from_png(path);
    assert_int_equal(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    assert_int_equal(cairo_image_surface_get_width(surface), WIDTH);
    assert_int_equal(cairo_image_surface_get_height(surface), HEIGHT);
    for (int y = 0; y < HEIGHT; y++) {
        memcpy(pixels[y],
               cairo_image_surface_get_data(surface) +
                   (ptrdiff_t)y * cairo_image_surface_get_stride(surface),
               sizeof pixels[y]);
        for (int x = 0; x < WIDTH; x++) {
            pixels[y][x] &= 0xffffff;
        }
    }
    cairo_surface_destroy(surface);
}

static void a_window_shows_what_the_png_has(void **state)
{
    static uint32_t wanted[HEIGHT][WIDTH];
    static uint32_t shown[HEIGHT][WIDTH];
    const struct timespec look = {.tv_nsec = LOOK_MS * 1000000L};
    const char *pictures = scratch_path(*state, "pictures");
    struct run run;
    const char *const to_png[] = {program,  "--bus",   nowhere,     "--png", pictures,
                                  "--size", "640x480", "--seconds", "1",     NULL};
    run_start(&run, to_png);
    run_finish(&run);
    run_expect(&run, 0);
    run_free(&run);
    read_png(scratch_path(pictures, "00000.png"), wanted);

    const char *const to_window[] = {program,  "--bus",   nowhere, "--window",
                                     "--size", "640x480", NULL};
    run_start(&run, to_window);
    int differ = 1;
    for (int waited_ms = 0; differ && waited_ms < WAIT_MS; waited_ms += LOOK_MS) {
        (void)nanosleep(&look, NULL);
        read_screen(*state, shown);
        differ = memcmp(shown, wanted, sizeof shown);
    }
    assert_int_equal(differ, 0);
    assert_int_equal(kill(run.pid, SIGTERM), 0);
    run_finish(&run);
    run_expect(&run, 0);
    run_free(&run);
}

static void without_a_desktop_it_says_so(void **state)
{
    struct run run;
    char *display = strdup(getenv("DISPLAY"));
    (void)state;
    assert_int_equal(setenv("DISPLAY", ":4711", 1), 0);
    const char *const argv[] = {program, "--bus", nowhere, "--window", NULL};
    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, 1);
    assert_int_equal(strncmp(run.err, "isotherm-screen: there is no desktop", 36), 0);
    run_free(&run);
    assert_int_equal(setenv("DISPLAY", display, 1), 0);
    free(display);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_window_shows_what_the_png_has),
        cmocka_unit_test(without_a_desktop_it_says_so),
    };
    if (access("/usr/bin/Xvfb", X_OK)) {
        puts("skipped: Xvfb is not installed");
        return SKIPPED;
    }
    return cmocka_run_group_tests(tests, setup, teardown);
}
