/* The example program frames_to_png draws pictures of a stored visit. Near points are bright, far
 * points are dark. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>

#include "drivers/file/png.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define PROGRAM   ISOTHERM_BINARY_DIR "/drivers/examples/example_frames_to_png"
#define RECORDING "path=" ISOTHERM_SOURCE_DIR "/sim/stored/p01-v1"

static void run_program(struct run *run, const char *count, const char *prefix, const char *option)
{
    const char *const argv[] = {PROGRAM, "replay", count, prefix, option, "pace=asap", NULL};
    run_start(run, argv);
    run_finish(run);
}

static void each_frame_becomes_a_picture(void **state)
{
    struct run run;
    run_program(&run, "3", scratch_path(*state, "frame"), RECORDING);
    run_expect(&run, 0);
    assert_non_null(strstr(run.out, "frame2.png: 640 x 480 pixels, frame 2\n"));
    run_free(&run);

    const struct iso_png_expectation grey = {ISO_PIXEL_GREY8, 640, 480};
    for (int i = 0; i < 3; i++) {
        struct iso_image image = {0};
        char name[32];
        (void)snprintf(name, sizeof name, "frame%d.png", i);
        assert_int_equal(iso_png_read(scratch_path(*state, name), &grey, &image, NULL), 0);
        /* The face is in the middle, half a metre away. The corner has no measurement. */
        const uint8_t *samples = image.samples;
        assert_in_range(samples[216 * 640 + 320], 200, 230);
        assert_int_equal(samples[0], 0);
        iso_image_done(&image);
    }
}

static void errors_are_reported(void **state)
{
    struct run run;
    run_program(&run, "4", scratch_path(*state, "frame"),
                RECORDING); /* one more frame than there are */
    run_expect(&run, 1);
    assert_non_null(strstr(run.err, "no frame came\n"));
    run_free(&run);
    run_program(&run, "1", "/nonexistent/frame", RECORDING);
    run_expect(&run, 1);
    assert_non_null(strstr(run.err, "/nonexistent/frame0.png"));
    run_free(&run);
    run_program(&run, "1", scratch_path(*state, "frame"), "colour=red");
    run_expect(&run, 1);
    assert_non_null(strstr(run.err, "colour"));
    run_free(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(each_frame_becomes_a_picture, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(errors_are_reported, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
