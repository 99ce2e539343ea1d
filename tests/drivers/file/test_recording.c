/* The reader of recordings, with recordings that the test writes. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

/* Writes a recording `r` of three frames into the scratch directory. */
static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        stored_frames_write(scratch_path(*state, "r"), 3);
    }
    return error;
}

static const char *in_recording(void **state, const char *file)
{
    char name[256];
    (void)snprintf(name, sizeof name, "r/%s", file);
    return scratch_path(*state, name);
}

static struct iso_recording *open_recording(void **state)
{
    struct iso_recording *recording = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_recording_open(scratch_path(*state, "r"), &recording, &fault), 0);
    assert_string_equal(fault.text, "");
    return recording;
}

/* Asserts that opening fails with `error` and a line that ends in `end`. */
static void assert_refused(void **state, int error, const char *end)
{
    struct iso_recording *recording = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_recording_open(scratch_path(*state, "r"), &recording, &fault), error);
    assert_null(recording);
    size_t length = strlen(fault.text);
    assert_true(length >= strlen(end));
    assert_string_equal(fault.text + length - strlen(end), end);
    assert_int_equal(strncmp(fault.text, *state, strlen(*state)), 0);
}

static void reads_frames_exactly(void **state)
{
    struct iso_recording *recording = open_recording(state);
    struct iso_frame *frame;
    assert_int_equal(iso_recording_frames(recording), 3);
    assert_false(iso_recording_has_intensity(recording));
    assert_string_equal(iso_recording_meta(recording)->sensor, "astra");
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    assert_null(frame->intensity);
    for (size_t f = 0; f < 3; f++) {
        assert_int_equal(iso_recording_read(recording, f, frame, NULL), 0);
        assert_int_equal(frame->t_ns, 10000000000 + (int64_t)f * 125000000);
        assert_int_equal(frame->t_ns, iso_recording_t_ns(recording, f));
        assert_int_equal(frame->sequence, f);
        assert_int_equal(frame->width_px, STORED_WIDTH);
        assert_int_equal(frame->height_px, STORED_HEIGHT);
        assert_true(frame->camera.fy_px == 571.25);
        assert_true(iso_frame_depth_at(frame, 0, 0) == 0.0F);
        assert_true(iso_frame_depth_at(frame, 6, 4) == (float)(1046 + 100 * f) / 2);
        assert_true(iso_frame_depth_at(frame, 1, 3) == (float)(1031 + 100 * f) / 2);
        assert_int_equal(iso_frame_check(frame, NULL), 0);
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
}

static void times_keep_every_nanosecond(void **state)
{
    scratch_write_text(in_recording(state, "depth.txt"), "1305031102.175304001 depth/000000.png\n"
                                                         "1305031102.1753040019 depth/000001.png\n"
                                                         "1305031103 depth/000002.png");
    assert_refused(state, -EBADMSG, "depth.txt:2: time does not rise");
    scratch_write_text(in_recording(state, "depth.txt"), "1305031102.175304001 depth/000000.png\n"
                                                         "\t\n");
    assert_refused(state, -EBADMSG, "depth.txt:2: not `timestamp_s filename`");
    scratch_write_text(in_recording(state, "depth.txt"),
                       "# a comment\n\n1305031102.175304001\tdepth/000001.png\r\n"
                       "1305031103 depth/000000.png");
    struct iso_recording *recording = open_recording(state);
    assert_int_equal(iso_recording_frames(recording), 2);
    assert_int_equal(iso_recording_t_ns(recording, 0), 1305031102175304001);
    assert_int_equal(iso_recording_t_ns(recording, 1), 1305031103000000000);
    iso_recording_close(recording);
}

static void refuses_bad_lists(void **state)
{
    static const char *const bad[][2] = {
        {"0.1 depth/0.png\n0.1 depth/1.png\n", "depth.txt:2: time does not rise"},
        {"0.2 depth/0.png\n0.1 depth/1.png\n", "depth.txt:2: time does not rise"},
        {"nan depth/0.png\n", "depth.txt:1: not `timestamp_s filename`"},
        {"-1 depth/0.png\n", "depth.txt:1: not `timestamp_s filename`"},
        {"1e3 depth/0.png\n", "depth.txt:1: not `timestamp_s filename`"},
        {"9223372036 depth/0.png\n", "depth.txt:1: not `timestamp_s filename`"},
        {"99999999999 depth/0.png\n", "depth.txt:1: not `timestamp_s filename`"},
        {".5 depth/0.png\n", "depth.txt:1: not `timestamp_s filename`"},
        {"1.5\n", "depth.txt:1: not `timestamp_s filename`"},
        {"1.5 \n", "depth.txt:1: not `timestamp_s filename`"},
        {"1.5 a b\n", "depth.txt:1: not `timestamp_s filename`"},
        {"1.5 /etc/passwd\n", "depth.txt:1: file '/etc/passwd' is not inside the recording"},
        {"1.5 a/../../b\n", "depth.txt:1: file 'a/../../b' is not inside the recording"},
        {"1.5 ..\n", "depth.txt:1: file '..' is not inside the recording"},
        {"# nothing\n", "depth.txt: no frames"},
        {"", "depth.txt: no frames"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        scratch_write_text(in_recording(state, "depth.txt"), bad[i][0]);
        assert_refused(state, -EBADMSG, bad[i][1]);
    }
}

static void names_what_is_missing(void **state)
{
    struct iso_recording *recording = NULL;
    struct iso_fault fault;
    assert_int_equal(iso_recording_open(scratch_path(*state, "x"), &recording, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "x/recording.ini: No such file or directory"));
    assert_int_equal(unlink(in_recording(state, "depth.txt")), 0);
    assert_refused(state, -ENOENT, "r/depth.txt: No such file or directory");
    assert_int_equal(unlink(in_recording(state, "recording.ini")), 0);
    assert_refused(state, -ENOENT, "r/recording.ini: No such file or directory");
}

static void refuses_a_bad_ini_by_name(void **state)
{
    scratch_write_text(in_recording(state, "recording.ini"), "[recording]\nformt = 1\n");
    assert_refused(state, -EBADMSG, "r/recording.ini:2: unknown key 'formt' in [recording]");
    scratch_write(in_recording(state, "recording.ini"), "[recording]\n\0", 13);
    assert_refused(state, -EBADMSG, "r/recording.ini: not a text file (it holds a NUL byte)");
}

/* Asserts that frame 1 fails with a line that ends in `end`, and that frames 0 and 2 can still be
 * read. */
static void assert_frame_lost(void **state, int error, const char *end)
{
    struct iso_recording *recording = open_recording(state);
    struct iso_fault fault = {.text = ""};
    struct iso_frame *frame;
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    assert_int_equal(iso_recording_read(recording, 0, frame, NULL), 0);
    assert_int_equal(iso_recording_read(recording, 1, frame, &fault), error);
    assert_non_null(strstr(fault.text, "000001.png: "));
    assert_string_equal(fault.text + strlen(fault.text) - strlen(end), end);
    assert_int_equal(iso_recording_read(recording, 2, frame, NULL), 0);
    assert_true(iso_frame_depth_at(frame, 6, 4) == 623.0F);
    iso_frame_free(frame);
    iso_recording_close(recording);
}

static void loses_one_frame_only(void **state)
{
    const char *path = in_recording(state, "depth/000001.png");
    stored_plane_write(path, STORED_WIDTH, STORED_HEIGHT, 8, 1, 99);
    assert_frame_lost(state, -EBADMSG, "8-bit grey is not the expected kind of picture");
    stored_plane_write(path, STORED_HEIGHT, STORED_WIDTH, 16, 1, 99);
    assert_frame_lost(state, -EBADMSG, "5x7 pixels instead of 7x5");
    stored_plane_write(path, STORED_WIDTH, STORED_HEIGHT, 16, 3, 99);
    assert_frame_lost(state, -EBADMSG, "16-bit RGB is not the expected kind of picture");
    assert_int_equal(unlink(path), 0);
    assert_frame_lost(state, -ENOENT, "No such file or directory");
}

static void loses_a_frame_cut_at_any_length(void **state)
{
    size_t size;
    char *bytes = scratch_read(in_recording(state, "depth/000001.png"), &size);
    for (size_t length = 0; length < size; length += 3) {
        scratch_write(in_recording(state, "depth/000001.png"), bytes, length);
        assert_frame_lost(state, -EBADMSG, "");
    }
    free(bytes);
}

static void refuses_other_indices_and_shapes(void **state)
{
    struct iso_recording *recording = open_recording(state);
    struct iso_frame *frame;
    struct iso_fault fault;
    const struct iso_camera *camera = &iso_recording_meta(recording)->camera;
    assert_int_equal(iso_frame_new(camera, STORED_HEIGHT, STORED_WIDTH, false, &frame), 0);
    assert_int_equal(iso_recording_read(recording, 0, frame, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "r: frame of another shape"));
    iso_frame_free(frame);
    assert_int_equal(iso_frame_new(camera, STORED_WIDTH, STORED_HEIGHT, true, &frame), 0);
    assert_int_equal(iso_recording_read(recording, 0, frame, NULL), -EINVAL);
    iso_frame_free(frame);
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    assert_int_equal(iso_recording_read(recording, 3, frame, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "r: has no frame 3"));
    iso_frame_free(frame);
    iso_recording_close(recording);
}

/* ---- intensity -------------------------------------------------------------- */

static float intensity_of(void **state, size_t index)
{
    struct iso_recording *recording = open_recording(state);
    struct iso_frame *frame;
    assert_true(iso_recording_has_intensity(recording));
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    assert_int_equal(iso_recording_read(recording, index, frame, NULL), 0);
    float value = frame->intensity[STORED_WIDTH * STORED_HEIGHT - 1];
    iso_frame_free(frame);
    iso_recording_close(recording);
    return value;
}

static void matches_infrared_by_time(void **state)
{
    scratch_mkdir(in_recording(state, "ir"));
    /* There is one more image than there are depth frames. Two images are half a millisecond off,
     * and the images have both bit depths. */
    scratch_write_text(in_recording(state, "ir.txt"), "9.9 ir/none.png\n10.0005 ir/a.png\n"
                                                      "10.125 ir/b.png\n10.2495 ir/a.png\n");
    stored_plane_write(in_recording(state, "ir/a.png"), STORED_WIDTH, STORED_HEIGHT, 16, 1, 13107);
    stored_plane_write(in_recording(state, "ir/b.png"), STORED_WIDTH, STORED_HEIGHT, 8, 1, 51);
    assert_true(intensity_of(state, 0) == 0.2F);
    assert_true(intensity_of(state, 1) == 0.2F);
    assert_true(intensity_of(state, 2) == 0.2F);
    stored_plane_write(in_recording(state, "ir/b.png"), STORED_WIDTH, STORED_HEIGHT, 8, 1, 255);
    assert_true(intensity_of(state, 1) == 1.0F);
}

static void refuses_infrared_with_gaps(void **state)
{
    scratch_write_text(in_recording(state, "ir.txt"), "10 ir/a.png\n10.1262 ir/b.png\n");
    assert_refused(state, -EBADMSG, "r: no infrared or colour frame for depth/000001.png");
    scratch_write_text(in_recording(state, "ir.txt"), "10 ir/a.png\n10.1262 ir/b.png 3\n");
    assert_refused(state, -EBADMSG, "r/ir.txt:2: not `timestamp_s filename`");
}

static void reports_a_lost_infrared_frame(void **state)
{
    scratch_mkdir(in_recording(state, "ir"));
    scratch_write_text(in_recording(state, "ir.txt"), "10 ir/0.png\n10.125 ir/000001.png\n"
                                                      "10.25 ir/0.png\n");
    stored_plane_write(in_recording(state, "ir/0.png"), STORED_WIDTH, STORED_HEIGHT, 8, 1, 51);
    stored_plane_write(in_recording(state, "ir/000001.png"), STORED_WIDTH, STORED_HEIGHT, 8, 3, 1);
    assert_frame_lost(state, -EBADMSG, "8-bit RGB is not the expected kind of picture");
}

static void takes_colour_where_there_is_no_infrared(void **state)
{
    scratch_mkdir(in_recording(state, "rgb"));
    scratch_write_text(in_recording(state, "rgb.txt"),
                       "10 rgb/0.png\n10.125 rgb/0.png\n10.25 rgb/0.png\n");
    stored_plane_write(in_recording(state, "rgb/0.png"), STORED_WIDTH, STORED_HEIGHT, 8, 3, 102);
    float value = intensity_of(state, 1);
    assert_true(value > 0.39999F && value < 0.40001F);
}

/* ---- landmarks -------------------------------------------------------------- */

static void reads_landmarks(void **state)
{
    struct iso_recording *recording = open_recording(state);
    struct iso_recording_landmark *rows = NULL;
    size_t n = 7;
    struct iso_fault fault;
    assert_int_equal(iso_recording_landmarks(recording, &rows, &n, &fault), -ENOENT);
    assert_null(rows);
    assert_int_equal(n, 7);
    scratch_write_text(in_recording(state, "landmarks.csv"),
                       "frame,name,x_mm,y_mm,z_mm\n0,nasion,1,-2.5,700\n2,nose_tip,3e1,4,680\n");
    assert_int_equal(iso_recording_landmarks(recording, &rows, &n, NULL), 0);
    assert_int_equal(n, 2);
    assert_int_equal(rows[1].frame, 2);
    assert_string_equal(rows[1].name, "nose_tip");
    assert_true(rows[0].point_mm.y == -2.5 && rows[1].point_mm.x == 30.0);
    assert_true(rows[1].point_mm.z == 680.0);
    free(rows);
    iso_recording_close(recording);
}

static void refuses_bad_landmarks(void **state)
{
    static const char *const bad[][2] = {
        {"frame,name,x,y,z\n", ":1: header is not `frame,name,x_mm,y_mm,z_mm`"},
        {"", ":1: header is not `frame,name,x_mm,y_mm,z_mm`"},
        {"frame,name,x_mm,y_mm,z_mm\n0,a,1,2\n", ":2: not five fields"},
        {"frame,name,x_mm,y_mm,z_mm\n0,a,1,2,3,4\n", ":2: not five fields"},
        {"frame,name,x_mm,y_mm,z_mm\n3,a,1,2,3\n", ":2: no such frame"},
        {"frame,name,x_mm,y_mm,z_mm\n-1,a,1,2,3\n", ":2: no such frame"},
        {"frame,name,x_mm,y_mm,z_mm\n0,,1,2,3\n", ":2: bad name"},
        {"frame,name,x_mm,y_mm,z_mm\n0,a234567890123456789012345678901,1,2,3\n"
         "0,a2345678901234567890123456789012,1,2,3\n",
         ":3: bad name"},
        {"frame,name,x_mm,y_mm,z_mm\n0,a,1,nan,3\n", ":2: bad coordinate"},
        {"frame,name,x_mm,y_mm,z_mm\n0,a,1,2,3\n0,a,1,2,3\n", ":3: repeated row"},
        {"frame,name,x_mm,y_mm,z_mm\n1,a,1,2,3\n0,a,1,2,3\n", ":3: frames out of order"},
    };
    struct iso_recording *recording = open_recording(state);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct iso_recording_landmark *rows = NULL;
        size_t n = 0;
        struct iso_fault fault = {.text = ""};
        scratch_write_text(in_recording(state, "landmarks.csv"), bad[i][0]);
        assert_int_equal(iso_recording_landmarks(recording, &rows, &n, &fault), -EBADMSG);
        const char *at = strstr(fault.text, "r/landmarks.csv");
        assert_non_null(at);
        assert_string_equal(at + strlen("r/landmarks.csv"), bad[i][1]);
        assert_null(rows);
    }
    iso_recording_close(recording);
}

#define WITH_RECORDING(test) cmocka_unit_test_setup_teardown(test, setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_RECORDING(reads_frames_exactly),
        WITH_RECORDING(times_keep_every_nanosecond),
        WITH_RECORDING(refuses_bad_lists),
        WITH_RECORDING(names_what_is_missing),
        WITH_RECORDING(refuses_a_bad_ini_by_name),
        WITH_RECORDING(loses_one_frame_only),
        WITH_RECORDING(loses_a_frame_cut_at_any_length),
        WITH_RECORDING(refuses_other_indices_and_shapes),
        WITH_RECORDING(matches_infrared_by_time),
        WITH_RECORDING(refuses_infrared_with_gaps),
        WITH_RECORDING(reports_a_lost_infrared_frame),
        WITH_RECORDING(takes_colour_where_there_is_no_infrared),
        WITH_RECORDING(reads_landmarks),
        WITH_RECORDING(refuses_bad_landmarks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
