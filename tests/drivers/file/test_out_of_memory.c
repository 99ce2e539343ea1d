/* The Nth allocation fails, for every N until the call succeeds. Each failure returns -ENOMEM and
 * leaves the outputs untouched. The sanitizers check that no memory leaks. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/door_io.h"
#include "drivers/file/png.h"
#include "drivers/recording/recording.h"
#include "drivers/sensor/contract/sensor.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/memory/scarce_memory.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

enum { MOST = 100 }; /* no tested call makes more allocations */

static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        const char *directory = scratch_path(*state, "r");
        stored_frames_write(directory, 3);
        scratch_write_text(scratch_path(directory, "ir.txt"),
                           "10 ir/0.png\n10.125 ir/0.png\n10.25 ir/0.png\n");
        scratch_mkdir(scratch_path(directory, "ir"));
        stored_plane_write(scratch_path(directory, "ir/0.png"), STORED_WIDTH, STORED_HEIGHT, 8, 1,
                           7);
        scratch_write_text(scratch_path(directory, "landmarks.csv"),
                           "frame,name,x_mm,y_mm,z_mm\n0,nasion,1,2,3\n");
    }
    return error;
}

static int open_recording(void *context, struct iso_fault *fault)
{
    const char *directory = context;
    struct iso_recording *recording = NULL;
    int error = iso_recording_open(scratch_path(directory, "r"), &recording, fault);
    assert_int_equal(recording == NULL, error != 0);
    iso_recording_close(recording);
    return error;
}

static void opening_a_recording(void **state)
{
    assert_true(scarce_memory_exhaust(open_recording, *state, MOST) >= 8);
}

static int read_landmarks(void *context, struct iso_fault *fault)
{
    const char *directory = context;
    long kept = scarce_memory_left;
    struct iso_recording *recording = NULL;
    struct iso_recording_landmark *rows = NULL;
    size_t n = 0;
    scarce_memory_left = -1;
    assert_int_equal(iso_recording_open(scratch_path(directory, "r"), &recording, NULL), 0);
    scarce_memory_left = kept;
    int error = iso_recording_landmarks(recording, &rows, &n, fault);
    assert_int_equal(rows == NULL, error != 0);
    free(rows);
    iso_recording_close(recording);
    return error;
}

static void reading_landmarks(void **state)
{
    assert_true(scarce_memory_exhaust(read_landmarks, *state, MOST) >= 2);
}

static int read_png(void *context, struct iso_fault *fault)
{
    const char *directory = context;
    struct iso_image image = {0};
    int error = iso_png_read(scratch_path(directory, "r/depth/000000.png"), NULL, &image, fault);
    assert_int_equal(image.samples == NULL, error != 0);
    iso_image_done(&image);
    return error;
}

static void reading_a_picture(void **state)
{
    assert_true(scarce_memory_exhaust(read_png, *state, MOST) >= 1);
}

static int64_t now_ns;

static int open_sensor(void *context, struct iso_fault *fault)
{
    const char *directory = context;
    const struct iso_option option = {"path", scratch_path(directory, "r")};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    int error = iso_sensor_open("replay", &option, 1, &clock, &sensor, fault);
    assert_int_equal(sensor == NULL, error != 0);
    iso_sensor_close(sensor);
    return error;
}

static void opening_a_sensor(void **state)
{
    assert_true(scarce_memory_exhaust(open_sensor, *state, MOST) >= 3);
}

static int play(void *context, struct iso_fault *fault)
{
    const char *directory = context;
    const struct iso_option option = {"path", scratch_path(directory, "r")};
    struct iso_clock clock = manual_clock(&now_ns);
    const struct iso_frame *frame = NULL;
    struct iso_sensor *sensor = NULL;
    long kept = scarce_memory_left;
    scarce_memory_left = -1;
    assert_int_equal(iso_sensor_open("replay", &option, 1, &clock, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    scarce_memory_left = kept;
    int error = iso_sensor_wait(sensor, 0, &frame, fault);
    assert_int_equal(frame == NULL, error != 0);
    iso_sensor_close(sensor);
    return error;
}

static void playing_a_frame(void **state)
{
    assert_true(scarce_memory_exhaust(play, *state, MOST) >= 10);
}

static int open_door(void *context, struct iso_fault *fault)
{
    const char *directory = context;
    const struct iso_option option = {"inputs", scratch_path(directory, "inputs")};
    const struct iso_door_outputs initial = {{false}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    int error = iso_door_io_open("null", &option, 1, &clock, &initial, &io, fault);
    assert_int_equal(io == NULL, error != 0);
    iso_door_io_close(io);
    return error;
}

static void opening_a_door(void **state)
{
    assert_true(scarce_memory_exhaust(open_door, *state, MOST) >= 3);
}

#define WITH_RECORDING(test) cmocka_unit_test_setup_teardown(test, setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_RECORDING(opening_a_recording), WITH_RECORDING(reading_landmarks),
        WITH_RECORDING(reading_a_picture),   WITH_RECORDING(opening_a_sensor),
        WITH_RECORDING(playing_a_frame),     WITH_RECORDING(opening_a_door),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
