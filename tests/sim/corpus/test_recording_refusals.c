/* Frames and recordings that the writer refuses, and the files that exist after a refusal. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include <cmocka.h>

#include "tests/sim/corpus/written_recording.h"
#include "tests/support/scratch.h"

static void refuses_bad_landmarks(void **state)
{
    static const char *const names[] = {"", "a,b", "two words", "a2345678901234567890123456789012"};
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = written_create(state, &meta);
    struct iso_frame *frame = written_frame(false);
    assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(sim_recording_writer_landmark(writer, names[i], iso_vec3(1, 2, 3), NULL),
                         -EINVAL);
    }
    assert_int_equal(sim_recording_writer_landmark(writer, "nasion", iso_vec3(1, NAN, 3), NULL),
                     -EINVAL);
    written_finish(writer);
    assert_false(scratch_exists(scratch_path(*state, "r/landmarks.csv")));
    iso_frame_free(frame);
}

/* Asserts that the frame is refused with `error` and a message that contains `expected`. */
static void assert_refused(struct sim_recording_writer *writer, const struct iso_frame *frame,
                           int error, const char *expected)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_recording_writer_append(writer, frame, &fault), error);
    assert_non_null(strstr(fault.text, expected));
}

static void refuses_frames_that_do_not_fit(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = written_create(state, &meta);
    struct iso_frame *frame = written_frame(true);
    assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
    assert_refused(writer, frame, -EINVAL, "r: frame 1: time does not rise");
    frame->t_ns++;
    frame->camera.fx_px += 1e-9;
    assert_refused(writer, frame, -EINVAL, "r: frame 1: another camera");
    frame->camera = meta.camera;
    frame->depth_mm[3] = 6553.56F;
    assert_refused(writer, frame, -ERANGE, "r: frame 1: depth 6553.56 mm does not fit");
    frame->depth_mm[3] = 0.04F;
    assert_refused(writer, frame, -ERANGE, "r: frame 1: depth 0.04 mm does not fit");
    frame->depth_mm[3] = NAN;
    assert_refused(writer, frame, -EINVAL, "r: frame 1: depth");
    frame->depth_mm[3] = 500.0F;
    frame->intensity[9] = 1.001F;
    assert_refused(writer, frame, -EINVAL, "r: frame 1: intensity outside 0..1");
    float *intensity = frame->intensity;
    frame->intensity = NULL;
    assert_refused(writer, frame, -EINVAL, "r: frame 1: intensity in some frames only");
    frame->intensity = intensity;
    frame->intensity[9] = 1.0F;
    assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
    written_finish(writer);
    struct iso_recording *recording = written_open(state);
    assert_int_equal(iso_recording_frames(recording), 2);
    iso_recording_close(recording);
    iso_frame_free(frame);
}

static void refuses_time_before_zero(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = written_create(state, &meta);
    struct iso_frame *frame = written_frame(false);
    frame->t_ns = -1;
    assert_refused(writer, frame, -EINVAL, "r: frame 0: time does not rise");
    iso_frame_free(frame);
    sim_recording_writer_free(writer);
}

static void refuses_what_no_reader_would_accept(void **state)
{
    struct sim_recording_writer *writer = NULL;
    struct iso_recording_meta meta = written_meta();
    struct iso_fault fault;
    const char *path = scratch_path(*state, "r");
    assert_int_equal(sim_recording_writer_create(path, &meta, 0, &writer, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "r: png_level must be 1..9"));
    meta.unit_mm = 0.0;
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "r: unit_mm must be"));
    meta = written_meta();
    meta.camera.fy_px = NAN;
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -EINVAL);
    meta = written_meta();
    meta.sensor[0] = '\0';
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -EINVAL);
    assert_false(scratch_exists(path));
    assert_null(writer);
}

static void takes_an_empty_directory_only(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = NULL;
    struct iso_fault fault;
    const char *path = scratch_path(*state, "r");
    scratch_mkdir(path);
    scratch_write_text(scratch_path(path, "x"), "x");
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -EEXIST);
    assert_non_null(strstr(fault.text, "r: is not empty"));
    assert_int_equal(remove(scratch_path(path, "x")), 0);
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, NULL), 0);
    assert_int_equal(sim_recording_writer_finish(writer, &fault), -ENODATA);
    assert_non_null(strstr(fault.text, "r: no frames were written"));
    sim_recording_writer_free(writer);
    writer = NULL;
    path = scratch_path(*state, "no/parent");
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -ENOENT);
    assert_null(writer);
}

static void a_full_disk_is_reported(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = written_create(state, &meta);
    struct iso_frame *frame = written_frame(false);
    struct iso_fault fault = {.text = ""};
    struct rlimit unlimited, limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    limit = unlimited;
    limit.rlim_cur = 30;
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    int append_error = sim_recording_writer_append(writer, frame, &fault);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    assert_int_equal(append_error, -EFBIG);
    assert_non_null(strstr(fault.text, "r/depth/000000.png: File too large"));
    iso_frame_free(frame);
    sim_recording_writer_free(writer);
}

#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(refuses_bad_landmarks),         IN_SCRATCH(refuses_frames_that_do_not_fit),
        IN_SCRATCH(refuses_time_before_zero),      IN_SCRATCH(refuses_what_no_reader_would_accept),
        IN_SCRATCH(takes_an_empty_directory_only), IN_SCRATCH(a_full_disk_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
