/* The Nth allocation fails, for every N until all goes well: -ENOMEM, outputs untouched, and
 * (seen by the sanitizers) nothing leaks. The linker wraps the allocators of what is linked
 * statically. */
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
#include "drivers/image/png.h"
#include "drivers/recording/recording.h"
#include "drivers/sensor/sensor.h"
#include "tests/support/manual_clock.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

static long left = -1; /* allocations until one fails; negative: none does */

static bool denied(void)
{
    return left >= 0 && left-- == 0;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_reallocarray(void *old, size_t n, size_t size);
char *__real_strdup(const char *text);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_reallocarray(void *old, size_t n, size_t size);
char *__wrap_strdup(const char *text);

void *__wrap_malloc(size_t size)
{
    return denied() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return denied() ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return denied() ? NULL : __real_realloc(old, size);
}

void *__wrap_reallocarray(void *old, size_t n, size_t size)
{
    return denied() ? NULL : __real_reallocarray(old, n, size);
}

char *__wrap_strdup(const char *text)
{
    return denied() ? NULL : __real_strdup(text);
}

/* Calls `action` with the first, second, ... allocation failing, until none fails any more. Returns
 * how many failed. */
static int exhaust(int (*action)(const char *directory, struct iso_fault *fault),
                   const char *directory)
{
    for (int n = 0; n < 100; n++) {
        struct iso_fault fault = {""};
        left = n;
        int error = action(directory, &fault);
        bool all_went_well = left >= 0;
        left = -1;
        if (all_went_well) {
            assert_int_equal(error, 0);
            return n;
        }
        assert_int_equal(error, -ENOMEM);
        assert_non_null(strstr(fault.text, "out of memory"));
    }
    fail_msg("never went well");
    return 0;
}

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

static int open_recording(const char *directory, struct iso_fault *fault)
{
    struct iso_recording *recording = NULL;
    int error = iso_recording_open(scratch_path(directory, "r"), &recording, fault);
    assert_int_equal(recording == NULL, error != 0);
    iso_recording_close(recording);
    return error;
}

static void opening_a_recording(void **state)
{
    assert_true(exhaust(open_recording, *state) >= 8);
}

static int read_landmarks(const char *directory, struct iso_fault *fault)
{
    long kept = left;
    struct iso_recording *recording = NULL;
    struct iso_recording_landmark *rows = NULL;
    size_t n = 0;
    left = -1;
    assert_int_equal(iso_recording_open(scratch_path(directory, "r"), &recording, NULL), 0);
    left = kept;
    int error = iso_recording_landmarks(recording, &rows, &n, fault);
    assert_int_equal(rows == NULL, error != 0);
    free(rows);
    iso_recording_close(recording);
    return error;
}

static void reading_landmarks(void **state)
{
    assert_true(exhaust(read_landmarks, *state) >= 2);
}

static int read_png(const char *directory, struct iso_fault *fault)
{
    struct iso_image image = {0};
    int error = iso_png_read(scratch_path(directory, "r/depth/000000.png"), NULL, &image, fault);
    assert_int_equal(image.samples == NULL, error != 0);
    iso_image_done(&image);
    return error;
}

static void reading_a_picture(void **state)
{
    assert_true(exhaust(read_png, *state) >= 1);
}

static int64_t now_ns;

static int open_sensor(const char *directory, struct iso_fault *fault)
{
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
    assert_true(exhaust(open_sensor, *state) >= 3);
}

static int play(const char *directory, struct iso_fault *fault)
{
    const struct iso_option option = {"path", scratch_path(directory, "r")};
    struct iso_clock clock = manual_clock(&now_ns);
    const struct iso_frame *frame = NULL;
    struct iso_sensor *sensor = NULL;
    long kept = left;
    left = -1;
    assert_int_equal(iso_sensor_open("replay", &option, 1, &clock, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    left = kept;
    int error = iso_sensor_wait(sensor, 0, &frame, fault);
    assert_int_equal(frame == NULL, error != 0);
    iso_sensor_close(sensor);
    return error;
}

static void playing_a_frame(void **state)
{
    assert_true(exhaust(play, *state) >= 10);
}

static int open_door(const char *directory, struct iso_fault *fault)
{
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
    assert_true(exhaust(open_door, *state) >= 3);
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
